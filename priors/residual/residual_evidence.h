// Information of all measured shapes together on the errors of a simulation.
#pragma once

#include "priors/dynamic_residual.h"
#include "priors/interpolator.h"

namespace chladni::priors {

/// The parameters of the dynamic residual's prior and the noise of the data.
struct ResidualErrors {
  DynamicResidual prior;
  double noise = 1.0;  ///< real noise over the stated noise
};

/// Data on the simulation's modes for the prior: the computed modes, and the modes above
/// them. The latter are estimated from the growth of the frequencies in the upper half (a
/// power of the mode number).
struct ModalBasis {
  Eigen::VectorXd frequency_hz;  ///< r
  Eigen::MatrixXd gram;          ///< r×r: mean of ψ ψᵀ over the surface, along its directions
  Eigen::VectorXd beyond_hz;     ///< of some higher modes; may be empty
  double beyond_square = 0.0;    ///< mean square of each of these modes
};
/// Cost: N r².
[[nodiscard]] ModalBasis modal_basis(const Simulation& simulation);

/// Prior distribution of the coefficients of one real shape on the simulation's modes.
struct CoefficientPrior {
  Eigen::VectorXd variance;  ///< r, up to one scale
  double beyond = 0.0;       ///< part of the expected mean square in the higher modes
  Eigen::MatrixXd slopes;    ///< r×3: of ln variance by ln η, ln κ, ln γ
  Eigen::Vector3d beyond_slopes = Eigen::Vector3d::Zero();  ///< of `beyond`
};

/// Variances of the coefficients of a shape at 0 Hz, up to one scale: a rigid-body motion, which
/// only rigid-body modes contain. A simulation that is held has none, and its softest modes take
/// their place: 1/ω², the limit of `coefficient_variances` for low frequencies.
/// @param frequency_hz  any modes
/// @param lowest_hz     of all the simulation's modes
[[nodiscard]] Eigen::VectorXd variances_at_rest(const Eigen::VectorXd& frequency_hz,
                                                double lowest_hz);

/// The prior of the real shape at `real_hz`; at 0 Hz that of `variances_at_rest`.
[[nodiscard]] CoefficientPrior coefficient_prior(const ModalBasis& basis, double real_hz,
                                                 const DynamicResidual& prior);

/// Deviation of a shape's values: the noise and the part beyond the r modes, s.
[[nodiscard]] Eigen::VectorXd deviation_of_values(const MeasuredShapes& measured, Eigen::Index mode,
                                                  double noise, double beyond);

/// Σ ln p(y_i) over the shapes, each with its most likely amplitude, and its slopes by ln η, ln κ,
/// ln γ and ln noise. Cost per shape: a decomposition of min(places, modes) rows.
struct PooledEvidence {
  double log_evidence = 0.0;
  Eigen::Vector4d slopes = Eigen::Vector4d::Zero();
  /// r×r, symmetric: small changes dK of the simulation's stiffness diag λ [s^-2] and dM of its
  /// mass I change the evidence by the sum of their products with these entries. Only on request.
  Eigen::MatrixXd stiffness_slopes, mass_slopes;
};
[[nodiscard]] PooledEvidence pooled_evidence(const MeasuredShapes& measured,
                                             const ModalBasis& basis, const ResidualErrors& errors,
                                             bool matrix_slopes = false);

/// Prior of the errors before any measurement: each number is log-normal.
struct ResidualPlausible {
  Eigen::Vector4d middle{0.1, 5.0, 0.8, 1.0};   ///< η, κ, γ, noise
  Eigen::Vector4d spread{1.0, 1.5, 0.5, 0.25};  ///< of their logarithms
};

/// Sentences on the numbers that are far from their prior.
[[nodiscard]] std::vector<std::string> doubts_of(const ResidualErrors& errors,
                                                 const ResidualPlausible& plausible);

/// The most likely errors under the measurement and the prior. The search starts at
/// the best of a few γ.
struct LearnedErrors {
  ResidualErrors errors;
  double log_evidence = 0.0;
  int evaluations = 0;
  std::vector<std::string> doubts;  ///< numbers that are far from their prior
};
[[nodiscard]] LearnedErrors learned_errors(const MeasuredShapes& measured, const ModalBasis& basis,
                                           const ResidualPlausible& plausible = {});

}  // namespace chladni::priors
