// Random fields on a surface of any form, from its own harmonics: smooth along it, not across gaps.
#pragma once

#include <limits>

#include "priors/spline/smoother.h"

namespace chladni::priors {

/// Smoothness of the heat kernel.
inline constexpr double kInfinitelySmooth = std::numeric_limits<double>::infinity();
/// Smoothness of what has a slope across the free rims of its surface, see below.
inline constexpr double kRimSmoothness = 1.0;

/// S_j, the variances of a field's coefficients on the harmonics −Δ u_j = μ_j u_j, scaled so that
/// the mean variance over the surface is 1. The Matern field of smoothness ν on a surface, S ∝
/// (2ν/l² + μ)^−(ν+1); the heat kernel, S ∝ exp(−l² μ / 2), where ν is infinite. On a plane far
/// from its rims these are the Matern and the squared exponential kernel of length l (Lindgren, Rue
/// and Lindstrom 2011; Borovitskiy et al. 2020). At a free rim the harmonics have no slope across
/// it, a plate that bends has: the coefficients of such a shape fall as 1/μ, as the deviations of
/// ν = 1 do. Smoother fields are too sure of themselves near the rims: on eight modes of a slotted
/// plate their bands held 54 % of the truth with ν = 2.5, 95 % with ν = 1. So are fields of few
/// harmonics: on a coarser mesh 80, 100 and 150 gave 90, 92 and 94 %.
/// @param eigenvalue   h: μ [1/m²]
/// @param mean_square  h: of each harmonic over the surface
/// @param length       l [m]
/// @throws InvalidInput  length or ν is not positive
[[nodiscard]] Eigen::VectorXd harmonic_variances(const Eigen::VectorXd& eigenvalue,
                                                 const Eigen::VectorXd& mean_square, double length,
                                                 double smoothness = kRimSmoothness);

/// k(x, x') = Σ_j S_j u_j(x) u_j(x'). @param a  N×h, @param b  n×h: the harmonics; @returns N×n
/// @throws InvalidInput  as many harmonics as variances are expected
[[nodiscard]] Eigen::MatrixXd surface_covariance(const Eigen::VectorXd& variances,
                                                 const Eigen::MatrixXd& a,
                                                 const Eigen::MatrixXd& b);

/// What is known of one shape: a constant, unknown, and a field of this length and amplitude.
struct SurfaceFit {
  double length = 0.0;        ///< [m]
  bool at_bound = false;      ///< of the lengths
  Eigen::VectorXd variances;  ///< h: S of that length
  Eigen::VectorXd noise;      ///< s: relative to the smoothing's
  Smoothing smoothing;        ///< amplitude² = noise² / λ; infinite λ: the constant alone
};

/// The length and amplitude of greatest restricted likelihood, noise as stated. 32 lengths between
/// what the finest harmonic resolves, 2/√μ_h, and the surface's own, 2π/√μ_1; of each the amplitude
/// from one decomposition (Smoother). Cost: 32 (10 s³ + s² h).
/// @param values, noise  s; @param harmonics  s×h, h > 1
/// @throws InvalidInput  sizes differ, all harmonics are constant
[[nodiscard]] SurfaceFit surface_fit(const Eigen::VectorXd& values, const Eigen::VectorXd& noise,
                                     const Eigen::MatrixXd& harmonics,
                                     const Eigen::VectorXd& eigenvalue,
                                     const Eigen::VectorXd& mean_square,
                                     double smoothness = kRimSmoothness);

/// The smoother of such a fit, at places with these harmonics (s×h).
[[nodiscard]] Smoother surface_smoother(const SurfaceFit& fit, const Eigen::MatrixXd& harmonics);

}  // namespace chladni::priors
