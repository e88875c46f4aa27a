#include "diagnosis/attached/loaded_damping.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "diagnosis/constants.h"

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

double gap(double a, double b) { return a + b > 0.0 ? 2.0 * std::abs(a - b) / (a + b) : 0.0; }

// The rotation of the loaded modes first to last - 1, which are nearly repeated, that is nearest to
// what they have in common with the structure's modes of these numbers. Two modes count the less
// the farther they are apart.
MatrixXd turn(const MatrixXd& mass, const MatrixXd& vectors, const VectorXd& omega, double width,
              Index first, Index last) {
  const Index count = last - first;
  MatrixXd common = vectors.middleCols(first, count).transpose() * mass.middleCols(first, count);
  for (Index j = 0; j < count; ++j) {
    for (Index k = 0; k < count; ++k) {
      const double apart = gap(omega(first + j), omega(first + k)) / width;
      common(j, k) *= std::exp(-0.5 * apart * apart);
    }
  }
  const Eigen::JacobiSVD<MatrixXd> parts(common, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return parts.matrixU() * parts.matrixV().transpose();
}

// Within a repeated mode an eigensolver may return any two shapes, and others for a change in the
// last bit. With ratios that differ D would jump with them. So the ratios of such modes are those
// of the structure's modes that they are made of. Modes that are six widths apart do not count
// (exp(-18)).
MatrixXd turn_to_structure(const MatrixXd& mass, const MatrixXd& vectors, const VectorXd& omega,
                           double ratio) {
  const double width = std::max(kConstants.pair_width * 2.0 * ratio, kConstants.least_pair_width);
  MatrixXd turned = MatrixXd::Identity(omega.size(), omega.size());
  for (Index first = 0; first < omega.size();) {
    Index last = first + 1;
    while (last < omega.size() && gap(omega(last - 1), omega(last)) < 6.0 * width) ++last;
    if (last - first > 1) {
      turned.block(first, first, last - first, last - first) =
          turn(mass, vectors, omega, width, first, last);
    }
    first = last;
  }
  return turned;
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
  const VectorXd ratio = ratios(structure, own);
  const MatrixXd turned = turn_to_structure(mass, modes.eigenvectors(), omega, ratio.mean());
  const MatrixXd seen = modes.eigenvectors() * omega.cwiseSqrt().asDiagonal() * turned;
  return {mass * seen * (2.0 * ratio).cwiseMax(0.0).cwiseSqrt().asDiagonal(),
          own.cwiseMax(0.0).cwiseSqrt()};
}

}  // namespace chladni::diagnosis
