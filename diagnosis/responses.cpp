#include "diagnosis/responses.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "base/error.h"
#include "priors/dense.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

bool diagonal(const MatrixXd& matrix) { return matrix.isDiagonal(0.0); }

Complex factor(const Path& path, Complex s) {
  Complex value = path.gain;
  if (path.delay != 0.0) value *= std::exp(-s * path.delay);
  if (path.lag != 0.0) value /= 1.0 + s * path.lag;
  if (path.derivative != 0.0) value *= std::pow(s, path.derivative);
  return value;
}

// All attachments side by side, and the dynamic stiffness of each of their displacements.
struct Attachments {
  MatrixXd shapes;  // r×D
  explicit Attachments(const State& state) {
    Index count = 0;
    for (const auto& one : state.attached) count += one.shapes.cols();
    shapes.resize(state.mode_count(), count);
    count = 0;
    for (const auto& one : state.attached) {
      shapes.middleCols(count, one.shapes.cols()) = one.shapes;
      count += one.shapes.cols();
    }
  }
  [[nodiscard]] Eigen::VectorXcd stiffness(const State& state, Complex s) const {
    Eigen::VectorXcd all(shapes.cols());
    Index count = 0;
    for (const auto& one : state.attached) {
      all.segment(count, one.shapes.cols()).setConstant(dynamic_stiffness(one, s));
      count += one.shapes.cols();
    }
    return all;
  }
  // What they take from C Z⁻¹ and Z⁻¹ B, given W = Z⁻¹ F, on line k.
  void couple(const State& state, Complex s, const MatrixXcd& w, Eigen::Ref<MatrixXcd> left,
              Eigen::Ref<MatrixXcd> right) const {
    const Eigen::VectorXcd delta = stiffness(state, s);
    MatrixXcd middle = delta.asDiagonal() * (shapes.transpose().cast<Complex>() * w);
    middle.diagonal().array() += 1.0;
    const MatrixXcd m = middle.partialPivLu().solve(MatrixXcd(delta.asDiagonal()));
    const MatrixXcd from_outputs = w.transpose() * state.outputs.transpose().cast<Complex>();
    const MatrixXcd from_inputs = w.transpose() * state.inputs.cast<Complex>();
    left.noalias() -= w * (m.transpose() * from_outputs);
    right.noalias() -= w * (m * from_inputs);
  }
};

MatrixXd without_diagonal(MatrixXd matrix) {
  matrix.diagonal().setZero();
  return matrix;
}

}  // namespace

MatrixXcd product(const MatrixXd& a, const MatrixXcd& x) {
  MatrixXd real = MatrixXd::Zero(a.rows(), x.cols());
  MatrixXd imag = MatrixXd::Zero(a.rows(), x.cols());
  priors::dense::add_product(a, x.real(), 1.0, real);
  priors::dense::add_product(a, x.imag(), 1.0, imag);
  MatrixXcd result(a.rows(), x.cols());
  result.real() = real;
  result.imag() = imag;
  return result;
}

Eigen::VectorXcd factors(const std::vector<Path>& paths, Complex s) {
  Eigen::VectorXcd all(static_cast<Index>(paths.size()));
  for (Index i = 0; i < all.size(); ++i) all(i) = factor(paths[at(i)], s);
  return all;
}

MatrixXcd frame_responses(const State& state, Complex s) {
  MatrixXcd sum = MatrixXcd::Zero(state.output_count(), state.input_count());
  for (const auto& frame : state.frames) {
    const Complex z = frame.stiffness + s * frame.damping + s * s * frame.mass;
    sum += (frame.to_outputs * frame.from_inputs.transpose()).cast<Complex>() / z;
  }
  return sum;
}

MatrixXcd recorded(const State& state, const MatrixXcd& structure, Complex s) {
  MatrixXcd value(state.output_count(), state.input_count());
  const Eigen::VectorXcd out = factors(state.output_paths, s);
  const Eigen::VectorXcd in = factors(state.input_paths, s);
  for (Index j = 0; j < value.cols(); ++j) {
    for (Index i = 0; i < value.rows(); ++i) {
      value(i, j) = out(i) * in(j)*structure(state.output_of[at(i)], state.input_of[at(j)]);
    }
  }
  return value;
}

Complex dynamic_stiffness(const Attached& attached, Complex s) {
  const Complex spring = attached.stiffness + s * attached.damping;
  const Complex inertia = attached.mass * s * s;
  if (!attached.carried) return spring + inertia;
  return inertia * spring / (inertia + spring);
}

Body::Body(const State& state, const Eigen::VectorXd& omega, bool coupled)
    : omega_(omega),
      stiffness_(state.stiffness),
      loss_(state.loss),
      damping_(state.damping),
      mass_(state.mass),
      outputs_(state.outputs),
      inputs_(state.inputs) {
  if (diagonal(stiffness_) && diagonal(mass_)) {
    lambda_ = stiffness_.diagonal().cwiseQuotient(mass_.diagonal());
    if ((mass_.diagonal().array() != 1.0).any()) {
      turn_ = mass_.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
    }
  } else {
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(stiffness_, mass_);
    if (modes.info() != Eigen::Success) throw NumericalFailure("a mass that is not positive");
    lambda_ = modes.eigenvalues();
    turn_ = modes.eigenvectors();
  }
  const bool turned = turn_.size() > 0;
  turned_damping_ = turned ? MatrixXd(turn_.transpose() * damping_ * turn_) : damping_;
  turned_loss_ = turned ? MatrixXd(turn_.transpose() * loss_ * turn_) : loss_;
  coupled_ = coupled && (!diagonal(turned_damping_) || !diagonal(turned_loss_));
  diagonal_inverse_.resize(state.mode_count(), omega.size());
  for (Index k = 0; k < omega.size(); ++k) {
    const double w = omega(k);
    diagonal_inverse_.col(k).real() = lambda_.array() - w * w;
    diagonal_inverse_.col(k).imag() = w * turned_damping_.diagonal() + turned_loss_.diagonal();
  }
  diagonal_inverse_ = diagonal_inverse_.cwiseInverse().eval();
  if (!diagonal_inverse_.allFinite()) throw NumericalFailure("a line on an undamped resonance");
  left_ = solve(outputs_.transpose());
  right_ = solve(inputs_);
}

bool Body::same(const State& state) const {
  return state.stiffness == stiffness_ && state.loss == loss_ && state.damping == damping_ &&
         state.mass == mass_;
}

MatrixXcd Body::solve(const MatrixXd& v) const {
  if (v.cols() == 0) return {v.rows(), 0};
  if (turn_.size() == 0) return iterated(v);
  return product(turn_, iterated(turn_.transpose() * v));
}

// X = d (V − j (ω D' + H') X), D' and H' without their diagonals: it contracts, since dissipation
// has no negative eigenvalue, and fast where modes are further apart than they are wide.
MatrixXcd Body::iterated(const MatrixXd& v) const {
  const Index c = v.cols();
  const Index lines = omega_.size();
  MatrixXcd x(v.rows(), c * lines);
  for (Index k = 0; k < lines; ++k) {
    x.middleCols(c * k, c) = diagonal_inverse_.col(k).asDiagonal() * v.cast<Complex>();
  }
  if (!coupled_) return x;
  const MatrixXd damping = without_diagonal(turned_damping_);
  const MatrixXd loss = without_diagonal(turned_loss_);
  const bool lossy = !loss.isZero(0.0);
  constexpr int kMost = 6;
  constexpr double kEnough = 1e-7;
  std::vector<Index> slow;
  for (int iteration = 0; iteration < kMost; ++iteration) {
    MatrixXcd coupled = product(damping, x);
    MatrixXcd lost;
    if (lossy) lost = product(loss, x);
    slow.clear();
    for (Index k = 0; k < lines; ++k) {
      MatrixXcd sum = Complex(0.0, -omega_(k)) * coupled.middleCols(c * k, c);
      if (lossy) sum -= Complex(0.0, 1.0) * lost.middleCols(c * k, c);
      sum += v.cast<Complex>();
      const MatrixXcd next = diagonal_inverse_.col(k).asDiagonal() * sum;
      const double change = (next - x.middleCols(c * k, c)).squaredNorm();
      if (change > kEnough * kEnough * next.squaredNorm()) slow.push_back(k);
      x.middleCols(c * k, c) = next;
    }
    if (slow.empty()) return x;
  }
  for (const auto k : slow) finish(k, v, x);
  return x;
}

void Body::finish(Index line, const MatrixXd& v, MatrixXcd& x) const {
  const double w = omega_(line);
  MatrixXcd z(lambda_.size(), lambda_.size());
  z.real() = (lambda_.array() - w * w).matrix().asDiagonal();
  z.imag() = w * turned_damping_ + turned_loss_;
  x.middleCols(v.cols() * line, v.cols()) = z.partialPivLu().solve(v.cast<Complex>());
}

MatrixXcd Body::left(const State& state) const {
  if (state.outputs.rows() == outputs_.rows() && state.outputs == outputs_) return left_;
  const Index p = state.output_count();
  std::vector<Index> moved;
  for (Index i = 0; i < p; ++i) {
    if (i >= outputs_.rows() || state.outputs.row(i) != outputs_.row(i)) moved.push_back(i);
  }
  const MatrixXcd fresh = solve(state.outputs(moved, Eigen::all).transpose());
  MatrixXcd columns(state.mode_count(), p * omega_.size());
  for (Index k = 0; k < omega_.size(); ++k) {
    const Index kept = std::min(p, outputs_.rows());
    columns.middleCols(p * k, kept) = left_.middleCols(outputs_.rows() * k, kept);
    for (std::size_t n = 0; n < moved.size(); ++n) {
      columns.col(p * k + moved[n]) =
          fresh.col(static_cast<Index>(moved.size()) * k + static_cast<Index>(n));
    }
  }
  return columns;
}

MatrixXcd Body::right(const State& state) const {
  if (state.inputs == inputs_) return right_;
  const Index q = state.input_count();
  std::vector<Index> moved;
  for (Index j = 0; j < q; ++j) {
    if (state.inputs.col(j) != inputs_.col(j)) moved.push_back(j);
  }
  const MatrixXcd fresh = solve(state.inputs(Eigen::all, moved));
  MatrixXcd columns = right_;
  for (Index k = 0; k < omega_.size(); ++k) {
    for (std::size_t n = 0; n < moved.size(); ++n) {
      columns.col(q * k + moved[n]) =
          fresh.col(static_cast<Index>(moved.size()) * k + static_cast<Index>(n));
    }
  }
  return columns;
}

Solved solved(const State& state, const Body& body) {
  const Index lines = body.omega().size();
  const Index p = state.output_count();
  const Index q = state.input_count();
  Solved result;
  result.omega = body.omega();
  result.left_columns = body.left(state);
  result.right_columns = body.right(state);
  result.structure.resize(lines, p * q);
  result.value.resize(lines, p * q);
  const Attachments attachments(state);
  const Index d = attachments.shapes.cols();
  const MatrixXcd w = body.solve(attachments.shapes);
  for (Index k = 0; k < lines; ++k) {
    const Complex s(0.0, body.omega()(k));
    auto left = result.left_columns.middleCols(p * k, p);
    auto right = result.right_columns.middleCols(q * k, q);
    if (d > 0) attachments.couple(state, s, w.middleCols(d * k, d), left, right);
    MatrixXcd structure = state.residual.cast<Complex>() + frame_responses(state, s);
    structure.noalias() += left.transpose() * state.inputs.cast<Complex>();
    result.structure.row(k) = structure.reshaped().transpose();
    result.value.row(k) = recorded(state, structure, s).reshaped().transpose();
  }
  return result;
}

MatrixXcd responses(const State& state, const Eigen::VectorXd& omega, bool coupled) {
  return solved(state, Body(state, omega, coupled)).value;
}

}  // namespace chladni::diagnosis
