#include "diagnosis/fit/state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/error.h"

namespace chladni::diagnosis {

namespace {

// Scales a matrix; its part `apart` keeps its size.
void scale(Eigen::MatrixXd& matrix, const Eigen::MatrixXd& apart, double factor) {
  matrix *= factor;
  if (apart.size() > 0) matrix += (1.0 - factor) * apart;
}

void attach(Eigen::MatrixXd& matrix, Eigen::MatrixXd& apart, const Eigen::MatrixXd& more) {
  matrix += more;
  if (apart.size() == 0) {
    apart = more;
  } else {
    apart += more;
  }
}

}  // namespace

State state_of(const Structure& structure) {
  const Eigen::Index r = structure.mode_count();
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * structure.frequency_hz;
  State state;
  state.stiffness = omega.cwiseAbs2().asDiagonal();
  if (structure.correction.size() > 0) state.stiffness += structure.correction;
  state.loss = Eigen::MatrixXd::Zero(r, r);
  state.damping = (2.0 * structure.damping_ratio.cwiseProduct(omega)).asDiagonal();
  if (structure.dashpots.size() > 0) attach_damping(state, structure.dashpots);
  state.mass = Eigen::MatrixXd::Identity(r, r);
  state.springs = structure.springs;
  state.masses = structure.masses;
  state.outputs = structure.outputs.shapes;
  state.inputs = structure.inputs.shapes.transpose();
  state.residual = structure.residual;
  // A side that was not measured has no rows. The modes above are there all the same.
  const bool above = structure.outputs.upper.cols() > 0 && structure.inputs.upper.cols() > 0;
  state.output_upper =
      above ? structure.outputs.upper : Eigen::MatrixXd(structure.output_count(), 0);
  state.input_upper = above ? structure.inputs.upper : Eigen::MatrixXd(structure.input_count(), 0);
  state.output_paths.resize(static_cast<std::size_t>(structure.output_count()));
  state.input_paths.resize(static_cast<std::size_t>(structure.input_count()));
  state.output_of.resize(state.output_paths.size());
  state.input_of.resize(state.input_paths.size());
  std::iota(state.output_of.begin(), state.output_of.end(), 0);
  std::iota(state.input_of.begin(), state.input_of.end(), 0);
  return state;
}

void add_stiffness(State& state, const Eigen::MatrixXd& change) {
  const Eigen::Index r = state.mode_count();
  const Eigen::Index u = std::min(change.rows() - r, state.output_upper.cols());
  state.stiffness += change.topLeftCorner(r, r);
  if (u <= 0) return;
  const Eigen::MatrixXd own =
      Eigen::MatrixXd::Identity(u, u) + Eigen::MatrixXd(change.block(r, r, u, u));
  const Eigen::LLT<Eigen::MatrixXd> above(own);
  if (above.info() != Eigen::Success) {
    throw NumericalFailure("a place of the body loses more stiffness than it has");
  }
  const Eigen::MatrixXd cross = change.block(r, 0, u, r);
  const Eigen::MatrixXd dragged = above.solve(cross);
  const Eigen::MatrixXd outputs = state.output_upper.leftCols(u);
  const Eigen::MatrixXd inputs = state.input_upper.leftCols(u);
  state.stiffness -= cross.transpose() * dragged;
  state.outputs -= outputs * dragged;
  state.inputs -= (inputs * dragged).transpose();
  const Eigen::MatrixXd yields =
      above.solve(Eigen::MatrixXd(inputs.transpose())) - inputs.transpose();
  state.residual += outputs * yields;
}

void scale_residual(State& state, double factor) {
  state.residual *= factor;
  state.output_upper *= std::sqrt(factor);
  state.input_upper *= std::sqrt(factor);
}

void scale_stiffness(State& state, double factor) {
  scale(state.stiffness, state.springs, factor);
  scale_residual(state, 1.0 / factor);
}

void scale_mass(State& state, double factor) { scale(state.mass, state.masses, factor); }

void scale_damping(State& state, double factor) {
  scale(state.damping, state.dashpots, factor);
  state.loss *= factor;
}

void note_kept_ratios(State& state, const Eigen::VectorXd& by) {
  if (state.kept_ratios.size() == 0) state.kept_ratios = Eigen::VectorXd::Ones(state.mode_count());
  state.kept_ratios = state.kept_ratios.cwiseProduct(by);
}

void deviate_damping(State& state, Eigen::Index i, double by) {
  auto& relative = state.relative_damping;
  if (relative.size() == 0) relative = Eigen::VectorXd::Zero(state.mode_count());
  state.damping(i, i) *= std::exp(by);
  relative(i) += (1.0 + relative(i)) * std::expm1(by);
}

void attach_stiffness(State& state, const Eigen::MatrixXd& springs) {
  attach(state.stiffness, state.springs, springs);
}
void attach_damping(State& state, const Eigen::MatrixXd& dashpots) {
  attach(state.damping, state.dashpots, dashpots);
}
void attach_mass(State& state, const Eigen::MatrixXd& masses) {
  attach(state.mass, state.masses, masses);
}

}  // namespace chladni::diagnosis
