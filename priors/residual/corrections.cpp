#include "priors/residual/corrections.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace chladni::priors {
namespace {

constexpr double kRigid = 1e-11;  // relative to the largest eigenvalue: 0 up to rounding

}  // namespace

std::optional<CorrectedModes> corrected_modes(const Eigen::VectorXd& frequency_hz,
                                              const std::vector<Correction>& corrections,
                                              const Eigen::VectorXd& parameters) {
  const auto r = frequency_hz.size();
  Eigen::MatrixXd stiffness = (2.0 * std::numbers::pi * frequency_hz).cwiseAbs2().asDiagonal();
  Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(r, r);
  for (std::size_t f = 0; f < corrections.size(); ++f) {
    const double value = parameters(static_cast<Eigen::Index>(f));
    if (corrections[f].stiffness.size() > 0) stiffness += value * corrections[f].stiffness;
    if (corrections[f].mass.size() > 0) mass += value * corrections[f].mass;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(mass);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd half = factor.matrixL().solve(stiffness);
  const Eigen::MatrixXd whole = factor.matrixL().solve(half.transpose());
  if (!whole.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(whole);
  const double most = solver.eigenvalues()(r - 1);
  if (solver.info() != Eigen::Success || !(solver.eigenvalues()(0) > -kRigid * most)) {
    return std::nullopt;
  }
  const Eigen::ArrayXd lambda = solver.eigenvalues();
  CorrectedModes modes;
  modes.frequency_hz =
      (lambda > kRigid * most).select(lambda.max(0.0).sqrt() / (2.0 * std::numbers::pi), 0.0);
  modes.turn = factor.matrixU().solve(solver.eigenvectors());
  return modes;
}

ModalBasis corrected_basis(const ModalBasis& basis, const CorrectedModes& modes) {
  ModalBasis corrected = basis;
  corrected.frequency_hz = modes.frequency_hz;
  corrected.gram = modes.turn.transpose() * basis.gram * modes.turn;
  return corrected;
}

MeasuredShapes corrected_measured(const MeasuredShapes& measured, const CorrectedModes& modes) {
  MeasuredShapes corrected = measured;
  corrected.places.shapes = measured.places.shapes * modes.turn;
  return corrected;
}

std::optional<CorrectedEvidence> corrected_evidence(const MeasuredShapes& measured,
                                                    const ModalBasis& basis,
                                                    const std::vector<Correction>& corrections,
                                                    const ResidualErrors& errors,
                                                    const Eigen::VectorXd& parameters) {
  const auto modes = corrected_modes(basis.frequency_hz, corrections, parameters);
  if (!modes) return std::nullopt;
  const auto pooled = pooled_evidence(corrected_measured(measured, *modes),
                                      corrected_basis(basis, *modes), errors, true);
  const Eigen::MatrixXd& turn = modes->turn;
  const Eigen::MatrixXd of_stiffness = turn * pooled.stiffness_slopes * turn.transpose();
  const Eigen::MatrixXd of_mass = turn * pooled.mass_slopes * turn.transpose();
  CorrectedEvidence evidence{pooled.log_evidence, Eigen::VectorXd::Zero(4 + parameters.size())};
  evidence.slopes.head<4>() = pooled.slopes;
  for (std::size_t f = 0; f < corrections.size(); ++f) {
    double& slope = evidence.slopes(4 + static_cast<Eigen::Index>(f));
    const auto& one = corrections[f];
    if (one.stiffness.size() > 0) slope += of_stiffness.cwiseProduct(one.stiffness).sum();
    if (one.mass.size() > 0) slope += of_mass.cwiseProduct(one.mass).sum();
  }
  return evidence;
}

}  // namespace chladni::priors
