// What all measured shapes together say of the errors of a simulation.
#pragma once

#include "priors/dynamic_residual.h"
#include "priors/interpolator.h"

namespace chladni::priors {

/// The numbers that the dynamic residual's prior has, and the noise that the data have.
struct ResidualErrors {
  DynamicResidual prior;
  double noise = 1.0;  ///< the real noise over the stated one
};

/// What the prior needs to know of the simulation's modes: those that were computed, and those
/// above them, guessed from how the frequencies of the upper half grow (a power of their number).
struct ModalBasis {
  Eigen::VectorXd frequency_hz;  ///< r
  Eigen::MatrixXd gram;          ///< r×r: mean of ψ ψᵀ over the surface, along its directions
  Eigen::VectorXd beyond_hz;     ///< of some higher modes; may be empty
  double beyond_square = 0.0;    ///< mean square of each of those
};
/// Cost: N r².
[[nodiscard]] ModalBasis modal_basis(const Simulation& simulation);

/// How the coefficients of one real shape on the simulation's modes are distributed.
struct CoefficientPrior {
  Eigen::VectorXd variance;  ///< r, up to one scale
  double beyond = 0.0;       ///< the part of its expected mean square that higher modes carry
  Eigen::MatrixXd slopes;    ///< r×3: of ln variance with ln η, ln κ, ln γ
  Eigen::Vector3d beyond_slopes = Eigen::Vector3d::Zero();  ///< of `beyond`
};

/// The prior of the real shape at `real_hz`; at 0 Hz it is a motion as a whole, which only
/// rigid-body modes carry.
[[nodiscard]] CoefficientPrior coefficient_prior(const ModalBasis& basis, double real_hz,
                                                 const DynamicResidual& prior);

/// The noise of a shape's values and what the r modes cannot show of it, s.
[[nodiscard]] Eigen::VectorXd deviation_of_values(const MeasuredShapes& measured, Eigen::Index mode,
                                                  double noise, double beyond);

/// Σ ln p(y_i) over the shapes, each with its likeliest amplitude, and its slopes with ln η, ln κ,
/// ln γ and ln noise. Cost per shape: a decomposition of as many rows as places or modes.
struct PooledEvidence {
  double log_evidence = 0.0;
  Eigen::Vector4d slopes = Eigen::Vector4d::Zero();
  /// r×r, symmetric: small changes dK of the simulation's stiffness diag λ [s^-2] and dM of its
  /// mass I add the sum of products of their entries with these. Empty unless asked for.
  Eigen::MatrixXd stiffness_slopes, mass_slopes;
};
[[nodiscard]] PooledEvidence pooled_evidence(const MeasuredShapes& measured,
                                             const ModalBasis& basis, const ResidualErrors& errors,
                                             bool matrix_slopes = false);

/// What is thought of the errors before anything is measured: each number log-normal.
struct ResidualPlausible {
  Eigen::Vector4d middle{0.1, 5.0, 0.8, 1.0};   ///< η, κ, γ, noise
  Eigen::Vector4d spread{1.0, 1.5, 0.5, 0.25};  ///< of their logarithms
};

/// The likeliest errors under what is measured and what is plausible, from several starts.
struct LearnedErrors {
  ResidualErrors errors;
  double log_evidence = 0.0;
  int evaluations = 0;
  std::vector<std::string> doubts;  ///< numbers that are far from what is plausible
};
[[nodiscard]] LearnedErrors learned_errors(const MeasuredShapes& measured, const ModalBasis& basis,
                                           const ResidualPlausible& plausible = {});

}  // namespace chladni::priors
