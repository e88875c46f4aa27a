#include "diagnosis/loaded_damping.h"

#include <Eigen/Eigenvalues>
#include <numbers>

#include "base/error.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Springs and masses that hang on a state, in its matrices.
void take_in(const std::vector<Attached>& all, MatrixXd& stiffness, MatrixXd& mass) {
  for (const auto& one : all) {
    if (one.carried) continue;
    const MatrixXd square = one.shapes * one.shapes.transpose();
    stiffness += one.stiffness * square;
    mass += one.mass * square;
  }
}

// Of the modes one by one, as a state damps those of the structure.
VectorXd ratios(const Structure& structure, const State& state) {
  const VectorXd omega = 2.0 * std::numbers::pi * structure.frequency_hz;
  VectorXd own = state.damping.diagonal();
  if (state.dashpots.size() > 0) own -= state.dashpots.diagonal();
  const Index flexible = structure.mode_count() - structure.rigid_count;
  VectorXd ratio(omega.size());
  ratio.tail(flexible) = own.tail(flexible).cwiseQuotient(2.0 * omega.tail(flexible));
  ratio.head(structure.rigid_count).setConstant(ratio.tail(flexible).mean());
  return ratio;
}

}  // namespace

MatrixXd loaded_damping(const Structure& structure, const std::vector<Supposed>& causes) {
  const State bare = state_of(structure);
  State loaded = bare;
  for (const auto& cause : causes) change_of(cause, structure)(loaded);
  MatrixXd stiffness = loaded.stiffness;
  MatrixXd mass = loaded.mass;
  take_in(loaded.attached, stiffness, mass);
  if (stiffness == bare.stiffness && mass == bare.mass) return {};
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(stiffness, mass);
  if (modes.info() != Eigen::Success) throw NumericalFailure("a mass that is not positive");
  const VectorXd omega = modes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const MatrixXd seen = mass * modes.eigenvectors();
  const VectorXd losses = 2.0 * ratios(structure, loaded).cwiseProduct(omega);
  MatrixXd gained = seen * losses.asDiagonal() * seen.transpose() - loaded.damping;
  if (loaded.dashpots.size() > 0) gained += loaded.dashpots;
  return gained;
}

}  // namespace chladni::diagnosis
