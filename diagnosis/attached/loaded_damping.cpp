#include "diagnosis/attached/loaded_damping.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <numbers>

#include "base/error.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Adds the springs and masses attached to a state to its matrices.
void take_in(const std::vector<Attached>& all, MatrixXd& stiffness, MatrixXd& mass) {
  for (const auto& one : all) {
    if (one.carried) continue;
    const MatrixXd square = one.shapes * one.shapes.transpose();
    stiffness += one.stiffness * square;
    mass += one.mass * square;
  }
}

// Losses of the single modes, as the state has them for the structure's modes.
VectorXd losses_of(const State& state) {
  VectorXd own = state.damping.diagonal();
  if (state.dashpots.size() > 0) own -= state.dashpots.diagonal();
  return own;
}

VectorXd ratios(const Structure& structure, const VectorXd& losses) {
  const VectorXd omega = 2.0 * std::numbers::pi * structure.frequency_hz;
  const Index flexible = structure.mode_count() - structure.rigid_count;
  VectorXd ratio(omega.size());
  ratio.tail(flexible) = losses.tail(flexible).cwiseQuotient(2.0 * omega.tail(flexible));
  ratio.head(structure.rigid_count).setConstant(ratio.tail(flexible).mean());
  return ratio;
}

}  // namespace

MatrixXd LoadedDamping::gained(const VectorXd& relative) const {
  if (factor.size() == 0) return {};
  VectorXd share = VectorXd::Ones(factor.cols());
  if (relative.size() > 0) share += relative;
  MatrixXd more = factor * share.asDiagonal() * factor.transpose();
  more.diagonal() -= share.cwiseProduct(bare.cwiseAbs2());
  return more;
}

LoadedDamping loaded_damping(const Structure& structure, const std::vector<Supposed>& causes) {
  const State bare = state_of(structure);
  State loaded = bare;
  for (const auto& cause : causes) change_of(cause, structure)(loaded);
  MatrixXd stiffness = loaded.stiffness;
  MatrixXd mass = loaded.mass;
  take_in(loaded.attached, stiffness, mass);
  if (stiffness == bare.stiffness && mass == bare.mass) return {};
  // The eigensolver does not look whether its own factor of the mass exists.
  if (Eigen::LLT<MatrixXd>(mass).info() != Eigen::Success) {
    throw NumericalFailure("a mass that is not positive");
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(stiffness, mass);
  if (modes.info() != Eigen::Success) throw NumericalFailure("a hypothesis without eigenvalues");
  const VectorXd omega = modes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const VectorXd own = losses_of(loaded);
  const VectorXd losses = 2.0 * ratios(structure, own).cwiseProduct(omega);
  return {mass * modes.eigenvectors() * losses.cwiseMax(0.0).cwiseSqrt().asDiagonal(),
          own.cwiseMax(0.0).cwiseSqrt()};
}

}  // namespace chladni::diagnosis
