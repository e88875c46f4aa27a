// The prior that a simulation gives for a real mode shape before any measurement.
#pragma once

#include <Eigen/Core>

namespace chladni::priors {

/// A real mode obeys (K − ω² M) φ = r with the simulation's K and M. The forces r come from the
/// model's errors and are random with covariance ε² ω² (K + κ ω² M). In the simulation's
/// mass-normalised modes ψ_j, φ = Σ c_j ψ_j with independent c_j, whose variances are
///
///     q_j = (r_j + κ) / ((r_j − 1)² + η²),   r_j = γ λ_j / ω²
///
/// up to one scale (the Bayesian form of Balmes' minimum dynamic residual expansion, 1999). The
/// prior does not depend on a rotation within repeated modes. It pairs no modes and needs no pairs.
struct DynamicResidual {
  double eta = 0.15;   ///< relative uncertainty of ω²: limits the resonance
  double kappa = 3.0;  ///< errors of the mass relative to those of the stiffness
  double gamma = 1.0;  ///< real stiffness per mass, relative to the simulation's
};

/// q_j of the m modes at `frequency_hz` (0 for rigid-body modes), for a real mode at `real_hz`.
/// @throws InvalidInput  real_hz, eta, kappa or gamma is not positive
[[nodiscard]] Eigen::VectorXd coefficient_variances(const Eigen::VectorXd& frequency_hz,
                                                    double real_hz,
                                                    const DynamicResidual& prior = {});

}  // namespace chladni::priors
