#include "diagnosis/responses.h"

#include <Eigen/LU>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

MatrixXcd dynamic(const State& state, Complex s) {
  return state.stiffness.cast<Complex>() + Complex(0.0, 1.0) * state.loss.cast<Complex>() +
         s * state.damping.cast<Complex>() + s * s * state.mass.cast<Complex>();
}

Complex factor(const Path& path, Complex s) {
  Complex value = path.gain;
  if (path.delay != 0.0) value *= std::exp(-s * path.delay);
  if (path.lag != 0.0) value /= 1.0 + s * path.lag;
  if (path.derivative != 0.0) value *= std::pow(s, path.derivative);
  return value;
}

bool diagonal(const MatrixXd& matrix) { return matrix.isDiagonal(0.0); }

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
  // What they take from C Z⁻¹ and Z⁻¹ B.
  void couple(const State& state, const Body& body, Index k, MatrixXcd& left,
              MatrixXcd& right) const {
    if (shapes.cols() == 0) return;
    const MatrixXcd w = body.solve(k, shapes);
    const Eigen::VectorXcd delta = stiffness(state, Complex(0.0, body.omega()(k)));
    MatrixXcd middle = delta.asDiagonal() * (shapes.transpose().cast<Complex>() * w);
    middle.diagonal().array() += 1.0;
    const MatrixXcd m = middle.partialPivLu().solve(MatrixXcd(delta.asDiagonal()));
    left.noalias() -= (state.outputs.cast<Complex>() * w) * (m * w.transpose());
    right.noalias() -= w * (m * (w.transpose() * state.inputs.cast<Complex>()));
  }
};

}  // namespace

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

Body::Body(const State& state, const Eigen::VectorXd& omega)
    : omega_(omega),
      stiffness_(state.stiffness),
      loss_(state.loss),
      damping_(state.damping),
      mass_(state.mass),
      diagonal_(diagonal(stiffness_) && diagonal(loss_) && diagonal(damping_) && diagonal(mass_)) {
  const Index lines = omega.size();
  const Index r = state.mode_count();
  if (diagonal_) {
    diagonal_inverse_.resize(r, lines);
    for (Index k = 0; k < lines; ++k) {
      const Complex s(0.0, omega(k));
      diagonal_inverse_.col(k) =
          (stiffness_.diagonal().cast<Complex>() +
           Complex(0.0, 1.0) * loss_.diagonal().cast<Complex>() +
           s * damping_.diagonal().cast<Complex>() + s * s * mass_.diagonal().cast<Complex>())
              .cwiseInverse();
    }
    if (!diagonal_inverse_.allFinite()) throw NumericalFailure("a line on an undamped resonance");
  } else {
    inverse_.resize(at(lines));
    parallel_ranges(at(lines), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Complex s(0.0, omega(static_cast<Index>(k)));
        inverse_[k] = dynamic(state, s).partialPivLu().inverse();
        if (!inverse_[k].allFinite()) throw NumericalFailure("a line on an undamped resonance");
      }
    });
  }
  outputs_ = state.outputs;
  inputs_ = state.inputs;
  left_.resize(at(lines));
  right_.resize(at(lines));
  for (Index k = 0; k < lines; ++k) {
    left_[at(k)] = solve(k, outputs_.transpose()).transpose();
    right_[at(k)] = solve(k, inputs_);
  }
}

bool Body::same(const State& state) const {
  return state.stiffness == stiffness_ && state.loss == loss_ && state.damping == damping_ &&
         state.mass == mass_;
}

MatrixXcd Body::solve(Index k, const MatrixXd& v) const {
  if (diagonal_) return diagonal_inverse_.col(k).asDiagonal() * v.cast<Complex>();
  MatrixXcd result(v.rows(), v.cols());
  result.real().noalias() = inverse_[at(k)].real() * v;
  result.imag().noalias() = inverse_[at(k)].imag() * v;
  return result;
}

MatrixXcd Body::left(Index k, const State& state) const {
  MatrixXcd rows(state.output_count(), state.mode_count());
  for (Index i = 0; i < rows.rows(); ++i) {
    if (i < outputs_.rows() && state.outputs.row(i) == outputs_.row(i)) {
      rows.row(i) = left_[at(k)].row(i);
    } else {
      rows.row(i) = solve(k, state.outputs.row(i).transpose()).transpose();
    }
  }
  return rows;
}

MatrixXcd Body::right(Index k, const State& state) const {
  MatrixXcd columns(state.mode_count(), state.input_count());
  for (Index j = 0; j < columns.cols(); ++j) {
    if (j < inputs_.cols() && state.inputs.col(j) == inputs_.col(j)) {
      columns.col(j) = right_[at(k)].col(j);
    } else {
      columns.col(j) = solve(k, state.inputs.col(j));
    }
  }
  return columns;
}

Solved solved(const State& state, const Body& body) {
  const auto lines = at(body.omega().size());
  const Index pq = state.output_count() * state.input_count();
  Solved result;
  result.omega = body.omega();
  result.left.resize(lines);
  result.right.resize(lines);
  result.structure.resize(body.omega().size(), pq);
  result.value.resize(body.omega().size(), pq);
  const Attachments attachments(state);
  parallel_ranges(lines, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const auto k = static_cast<Index>(n);
      const Complex s(0.0, body.omega()(k));
      result.left[n] = body.left(k, state);
      result.right[n] = body.right(k, state);
      attachments.couple(state, body, k, result.left[n], result.right[n]);
      MatrixXcd structure = result.left[n] * state.inputs.cast<Complex>();
      structure += state.residual.cast<Complex>() + frame_responses(state, s);
      result.structure.row(k) = structure.reshaped().transpose();
      result.value.row(k) = recorded(state, structure, s).reshaped().transpose();
    }
  });
  return result;
}

MatrixXcd responses(const State& state, const Eigen::VectorXd& omega) {
  return solved(state, Body(state, omega)).value;
}

}  // namespace chladni::diagnosis
