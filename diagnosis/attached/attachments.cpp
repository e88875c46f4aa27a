#include "diagnosis/attached/attachments.h"

#include <Eigen/LU>

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

Complex dynamic_stiffness(const Attached& attached, Complex s) {
  const Complex spring = attached.stiffness + s * attached.damping;
  const Complex inertia = attached.mass * s * s;
  if (!attached.carried) return spring + inertia;
  return inertia * spring / (inertia + spring);
}

Attachments::Attachments(const State& state) {
  Index count = 0;
  for (const auto& one : state.attached) count += one.shapes.cols();
  shapes.resize(state.mode_count(), count);
  const Index above = state.output_upper.cols();
  MatrixXd upper = MatrixXd::Zero(above, count);
  count = 0;
  for (const auto& one : state.attached) {
    shapes.middleCols(count, one.shapes.cols()) = one.shapes;
    if (one.upper.rows() == above && above > 0) {
      upper.middleCols(count, one.shapes.cols()) = one.upper;
    }
    count += one.shapes.cols();
  }
  own = upper.transpose() * upper;
  to_outputs = above > 0 ? MatrixXd(state.output_upper * upper)
                         : MatrixXd::Zero(state.output_count(), count);
  to_inputs =
      above > 0 ? MatrixXd(state.input_upper * upper) : MatrixXd::Zero(state.input_count(), count);
}

Eigen::VectorXcd Attachments::stiffness(const State& state, Complex s) const {
  Eigen::VectorXcd all(count());
  Index first = 0;
  for (const auto& one : state.attached) {
    all.segment(first, one.shapes.cols()).setConstant(dynamic_stiffness(one, s));
    first += one.shapes.cols();
  }
  return all;
}

Coupled couple(const Attachments& attachments, const State& state, Complex s, const MatrixXcd& w,
               Eigen::Ref<MatrixXcd> left, Eigen::Ref<MatrixXcd> right) {
  const Eigen::VectorXcd delta = attachments.stiffness(state, s);
  const MatrixXcd among =
      attachments.shapes.transpose().cast<Complex>() * w + attachments.own.cast<Complex>();
  MatrixXcd middle = delta.asDiagonal() * among;
  middle.diagonal().array() += 1.0;
  const MatrixXcd m = middle.partialPivLu().solve(MatrixXcd(delta.asDiagonal()));
  const MatrixXcd outputs = state.outputs.cast<Complex>() * w + attachments.to_outputs;
  const MatrixXcd inputs = state.inputs.transpose().cast<Complex>() * w + attachments.to_inputs;
  left.noalias() -= w * (outputs * m).transpose();
  right.noalias() -= w * (m * inputs.transpose());
  Coupled coupled;
  coupled.direct = -(outputs * m) * attachments.to_inputs.transpose().cast<Complex>();
  coupled.to_outputs = outputs - (outputs * m) * among;
  coupled.to_inputs = inputs - (inputs * m.transpose()) * among;
  return coupled;
}

}  // namespace chladni::diagnosis
