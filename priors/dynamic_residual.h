// What a simulation says about a real mode shape before it is measured.
#pragma once

#include <Eigen/Core>

namespace chladni::priors {

/// A real mode obeys (K − ω² M) φ = r with the simulation's K and M, where the forces r of what the
/// model gets wrong are random, ε² ω² (K + κ ω² M). In the simulation's mass-normalised modes ψ_j,
/// φ = Σ c_j ψ_j with independent c_j, whose variances are
///
///     q_j = (r_j + κ) / ((r_j − 1)² + η²),   r_j = γ λ_j / ω²
///
/// up to one scale (the Bayesian form of Balmes'
/// minimum dynamic residual expansion, 1999). It is blind to a rotation within repeated modes,
/// pairs no modes, and needs none to be there.
struct DynamicResidual {
  double eta = 0.15;   ///< relative uncertainty of ω²: caps the resonance
  double kappa = 3.0;  ///< errors of the mass against those of the stiffness
  double gamma = 1.0;  ///< the real stiffness per mass over the simulation's
};

/// q_j of the m modes with `frequency_hz` (rigid-body ones 0), for a real mode at `real_hz`.
/// @throws InvalidInput  real_hz, eta, kappa or gamma is not positive
[[nodiscard]] Eigen::VectorXd coefficient_variances(const Eigen::VectorXd& frequency_hz,
                                                    double real_hz,
                                                    const DynamicResidual& prior = {});

}  // namespace chladni::priors
