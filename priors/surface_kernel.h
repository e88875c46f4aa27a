// Random fields on a surface of any form, from its own harmonics: smooth along it, not across gaps.
#pragma once

#include <limits>

#include "priors/interpolator.h"

namespace chladni::priors {

/// Smoothness of the heat kernel.
inline constexpr double kInfinitelySmooth = std::numeric_limits<double>::infinity();

/// S_j, the variances of a field's coefficients on the harmonics −Δ u_j = μ_j u_j, scaled so that
/// the mean variance over the surface is 1.
struct HarmonicVariances {
  Eigen::VectorXd value;   ///< h
  Eigen::VectorXd slopes;  ///< h: of ln S_j with ln(length)
};

/// The Matern field of smoothness ν on a surface, S ∝ (2ν/l² + μ)^−(ν+1); the heat kernel, S ∝
/// exp(−l² μ / 2), where ν is infinite. On a plane far from its rims these are the Matern and the
/// squared exponential kernel of length l (Lindgren, Rue and Lindstrom 2011; Borovitskiy et al.
/// 2020). At a free rim the harmonics have no slope across it: what bends freely there is met less
/// well than by the structure's own modes.
/// @param mean_square  h: of each harmonic over the surface
/// @throws InvalidInput  length or ν is not positive
[[nodiscard]] HarmonicVariances harmonic_variances(const Eigen::VectorXd& eigenvalue,
                                                   const Eigen::VectorXd& mean_square,
                                                   double length, double smoothness = 2.5);

/// k(x, x') = Σ_j S_j u_j(x) u_j(x'). @param a  N×h, @param b  n×h: the harmonics; @returns N×n
[[nodiscard]] Eigen::MatrixXd surface_covariance(const HarmonicVariances& variances,
                                                 const Eigen::MatrixXd& a,
                                                 const Eigen::MatrixXd& b);

/// The length of greatest evidence for one shape, its amplitude the likeliest.
struct SurfaceLength {
  double length = 0.0;  ///< [m]
  double log_evidence = 0.0;
  bool at_bound = false;
};

/// Lengths between what the finest harmonic resolves, 2/√μ_h, and the surface's own, 2π/√μ_1: a
/// grid of 16, then its best refined with the exact slope.
/// @param values, noise  s; @param harmonics  s×h, h > 1
/// @throws InvalidInput  sizes differ, all harmonics are constant
[[nodiscard]] SurfaceLength learned_length(
    const Eigen::VectorXd& values, const Eigen::VectorXd& noise, const Eigen::MatrixXd& harmonics,
    const Eigen::VectorXd& eigenvalue, const Eigen::VectorXd& mean_square, double smoothness = 2.5);

}  // namespace chladni::priors
