#include "diagnosis/fit/responses.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/index.h"
#include "dense/algebra.h"
#include "diagnosis/attached/attachments.h"
#include "diagnosis/search/experiments.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

bool diagonal(const MatrixXd& matrix) { return matrix.isDiagonal(0.0); }

// Eigen's solver does not look whether its own factor of the mass exists.
bool is_positive(const MatrixXd& mass) {
  return mass.isDiagonal(0.0) ? (mass.diagonal().array() > 0.0).all()
                              : Eigen::LLT<MatrixXd>(mass).info() == Eigen::Success;
}

MatrixXd without_diagonal(MatrixXd matrix) {
  matrix.diagonal().setZero();
  return matrix;
}

}  // namespace

MatrixXcd product(const MatrixXd& a, const MatrixXcd& x) {
  constexpr Index kBlock = 256;  // columns per block, so that the parts stay in the cache
  MatrixXcd result(a.rows(), x.cols());
  MatrixXd parts, products;
  for (Index first = 0; first < x.cols(); first += kBlock) {
    const Index count = std::min(kBlock, x.cols() - first);
    parts.resize(x.rows(), 2 * count);
    parts.leftCols(count) = x.middleCols(first, count).real();
    parts.rightCols(count) = x.middleCols(first, count).imag();
    products.setZero(a.rows(), 2 * count);
    dense::add_product(a, parts, 1.0, products);
    result.middleCols(first, count).real() = products.leftCols(count);
    result.middleCols(first, count).imag() = products.rightCols(count);
  }
  return result;
}

Complex factor(const Path& path, Complex s) {
  Complex value = path.gain;
  if (path.delay != 0.0) value *= std::exp(-s * path.delay);
  if (path.lag != 0.0) value /= 1.0 + s * path.lag;
  if (path.derivative != 0.0) value *= std::pow(s, path.derivative);
  return value;
}

Eigen::VectorXcd factors(const std::vector<Path>& paths, Complex s) {
  Eigen::VectorXcd all(static_cast<Index>(paths.size()));
  for (Index i = 0; i < all.size(); ++i) all(i) = factor(paths[at(i)], s);
  return all;
}

MatrixXcd frame_response(const Frame& frame, Complex s) {
  return (frame.to_outputs * frame.from_inputs.transpose()).cast<Complex>() /
         (frame.stiffness + s * frame.damping + s * s * frame.mass);
}

MatrixXcd frame_responses(const State& state, Complex s) {
  MatrixXcd sum = MatrixXcd::Zero(state.output_count(), state.input_count());
  for (const auto& frame : state.frames) sum += frame_response(frame, s);
  return sum;
}

namespace {

// With the factors of the paths.
MatrixXcd recorded(const State& state, const MatrixXcd& structure, const Eigen::VectorXcd& out,
                   const Eigen::VectorXcd& in) {
  MatrixXcd value(state.output_count(), state.input_count());
  for (Index j = 0; j < value.cols(); ++j) {
    for (Index i = 0; i < value.rows(); ++i) {
      value(i, j) = out(i) * in(j)*structure(state.output_of[at(i)], state.input_of[at(j)]);
    }
  }
  return value;
}

}  // namespace

MatrixXcd recorded(const State& state, const MatrixXcd& structure, Complex s) {
  return recorded(state, structure, factors(state.output_paths, s), factors(state.input_paths, s));
}

Body::Body(const State& state, const Eigen::VectorXd& omega, bool coupled)
    : omega_(omega),
      stiffness_(state.stiffness),
      loss_(state.loss),
      damping_(state.damping),
      mass_(state.mass),
      outputs_(state.outputs),
      inputs_(state.inputs) {
  if (!is_positive(mass_)) throw NumericalFailure("a mass that is not positive");
  if (diagonal(stiffness_) && diagonal(mass_)) {
    lambda_ = stiffness_.diagonal().cwiseQuotient(mass_.diagonal());
    if ((mass_.diagonal().array() != 1.0).any()) {
      turn_ = mass_.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
    }
  } else {
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(stiffness_, mass_);
    if (modes.info() != Eigen::Success) throw NumericalFailure("a hypothesis without eigenvalues");
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

// X = d (V − j (ω D' + H') X), with D' and H' without their diagonals. The iteration contracts,
// because dissipation has no negative eigenvalue. It is fast if modes are further apart than they
// are wide.
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

// Columns of each line: kept where `now` equals `before`, otherwise solved for.
MatrixXcd Body::channels(const MatrixXd& now, const MatrixXd& before, const MatrixXcd& kept) const {
  if (now.cols() == before.cols() && now == before) return kept;
  std::vector<Index> moved;
  for (Index j = 0; j < now.cols(); ++j) {
    if (j >= before.cols() || now.col(j) != before.col(j)) moved.push_back(j);
  }
  const MatrixXcd fresh = solve(now(Eigen::all, moved));
  const auto count = static_cast<Index>(moved.size());
  const Index same = std::min(now.cols(), before.cols());
  MatrixXcd columns(now.rows(), now.cols() * omega_.size());
  for (Index k = 0; k < omega_.size(); ++k) {
    columns.middleCols(now.cols() * k, same) = kept.middleCols(before.cols() * k, same);
    for (Index n = 0; n < count; ++n) {
      columns.col(now.cols() * k + moved[at(n)]) = fresh.col(count * k + n);
    }
  }
  return columns;
}

MatrixXcd Body::left(const State& state) const {
  return channels(state.outputs.transpose(), outputs_.transpose(), left_);
}

MatrixXcd Body::right(const State& state) const { return channels(state.inputs, inputs_, right_); }

namespace {

template <typename Work>
void each_line(Index lines, const Work& work) {
  parallel_ranges(at(lines), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) work(static_cast<Index>(k));
  });
}

// Responses of a body that is the same in all experiments.
Solved steady(const State& state, const Body& body) {
  const Index lines = body.omega().size();
  const Index p = state.output_count();
  const Index q = state.input_count();
  Solved result;
  result.omega = body.omega();
  result.left_columns = body.left(state);
  result.right_columns = body.right(state);
  result.structure.resize(lines, p * q);
  result.value.resize(lines, p * q);
  result.output_factors.resize(p, lines);
  result.input_factors.resize(q, lines);
  const Attachments attachments(state);
  const Index d = attachments.count();
  const MatrixXcd w = body.solve(attachments.shapes);
  result.to_outputs.resize(p, d * lines);
  result.to_inputs.resize(q, d * lines);
  std::vector<MatrixXcd> attached(at(d > 0 ? lines : 0));
  const auto attach = [&](Index k) {
    auto left = result.left_columns.middleCols(p * k, p);
    auto right = result.right_columns.middleCols(q * k, q);
    const Complex s(0.0, body.omega()(k));
    auto coupled = couple(attachments, state, s, w.middleCols(d * k, d), left, right);
    attached[at(k)] = std::move(coupled.direct);
    result.to_outputs.middleCols(d * k, d) = coupled.to_outputs;
    result.to_inputs.middleCols(d * k, d) = coupled.to_inputs;
  };
  each_line(d > 0 ? lines : 0, attach);
  const MatrixXcd of_modes = product(state.inputs.transpose(), result.left_columns);  // q×pK
  each_line(lines, [&](Index k) {
    const Complex s(0.0, body.omega()(k));
    MatrixXcd structure = state.residual.cast<Complex>() + frame_responses(state, s);
    if (d > 0) structure += attached[at(k)];
    structure += of_modes.middleCols(p * k, p).transpose();
    result.structure.row(k) = structure.reshaped().transpose();
    result.output_factors.col(k) = factors(state.output_paths, s);
    result.input_factors.col(k) = factors(state.input_paths, s);
    result.value.row(k) =
        recorded(state, structure, result.output_factors.col(k), result.input_factors.col(k))
            .reshaped()
            .transpose();
  });
  return result;
}

}  // namespace

Solved solved(const State& state, const Body& body) {
  Solved result = steady(state, body);
  if (!drifts(state)) return result;
  const Index p = state.output_count();
  for (Index j = 0; j < state.input_count(); ++j) {
    const State one = experiment(state, j);
    result.experiments.push_back(steady(one, Body(one, body.omega(), body.coupled())));
    const auto& own = result.experiments.back();
    result.structure.middleCols(p * state.input_of[at(j)], p) = own.structure;
    result.value.middleCols(p * j, p) = own.value;
  }
  return result;
}

MatrixXcd responses(const State& state, const Eigen::VectorXd& omega, bool coupled) {
  return solved(state, Body(state, omega, coupled)).value;
}

}  // namespace chladni::diagnosis
