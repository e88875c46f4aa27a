// Fits as good as the Cramér-Rao bound allows, without fitting: the truth and a draw about it.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "identification/modal_fit.h"
#include "simulators/frf_bounds.h"
#include "simulators/portable_random.h"

namespace chladni::identification {

/// The truth as a fit without errors, with the covariance of the bound.
inline ModalFit true_fit(const simulators::FrfCase& made) {
  ModalFit fit;
  fit.model = made.truth;
  const auto bounds = simulators::cramer_rao(made);
  fit.frequency_std_hz = bounds.frequency_hz;
  fit.damping_std = bounds.damping;
  fit.output_std = bounds.outputs;
  fit.input_std = bounds.inputs;
  fit.mode_covariance = bounds.covariance;
  fit.rigid_covariance = bounds.rigid_covariance;
  return fit;
}

inline Eigen::VectorXd normal_draw(const Eigen::MatrixXd& covariance, simulators::Dice& dice) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  const Eigen::VectorXd root = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return solver.eigenvectors() * root.cwiseProduct(dice.normal(covariance.rows(), 1));
}

/// The same with L and R of every mode drawn about their values, each mode above 0 Hz by itself.
inline ModalFit drawn_fit(const ModalFit& mean, unsigned seed) {
  simulators::Dice dice(seed);
  auto fit = mean;
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  const auto r = fit.model.rigid_count;
  if (r > 0) {
    const Eigen::VectorXd error = normal_draw(fit.rigid_covariance, dice);
    fit.model.output_shapes.leftCols(r) += error.head(p * r).reshaped(p, r);
    fit.model.input_shapes.topRows(r) += error.tail(r * q).reshaped(r, q);
  }
  for (Eigen::Index m = r; m < fit.model.mode_count(); ++m) {
    const Eigen::VectorXd error = normal_draw(
        fit.mode_covariance[static_cast<std::size_t>(m)].bottomRightCorner(p + q, p + q), dice);
    fit.model.output_shapes.col(m) += error.head(p);
    fit.model.input_shapes.row(m) += error.tail(q).transpose();
  }
  return fit;
}

/// The same with all inputs turned, as by an amplifier that inverts, and the covariance following.
inline ModalFit with_turned_inputs(const ModalFit& fit) {
  auto other = fit;
  other.model.input_shapes *= -1.0;
  const auto q = fit.model.input_count();
  const auto turn = [](Eigen::MatrixXd& covariance, Eigen::Index inputs) {
    covariance.bottomRows(inputs) *= -1.0;
    covariance.rightCols(inputs) *= -1.0;
  };
  for (auto& covariance : other.mode_covariance) {
    if (covariance.size() > 0) turn(covariance, q);
  }
  if (fit.model.rigid_count > 0) turn(other.rigid_covariance, fit.model.rigid_count * q);
  return other;
}

/// L D and D⁻¹ R with the covariance following: the same responses.
inline ModalFit rescaled(const ModalFit& fit, const Eigen::VectorXd& factor) {
  auto other = fit;
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  for (Eigen::Index m = 0; m < factor.size(); ++m) {
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(2 + p + q);
    scale.segment(2, p).setConstant(factor(m));
    scale.tail(q).setConstant(1.0 / factor(m));
    other.model.output_shapes.col(m) *= factor(m);
    other.model.input_shapes.row(m) /= factor(m);
    auto& covariance = other.mode_covariance[static_cast<std::size_t>(m)];
    covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
  }
  return other;
}

}  // namespace chladni::identification
