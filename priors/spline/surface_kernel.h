// Random fields on a surface of any form, from its harmonics: smooth along it, not across gaps.
#pragma once

#include <limits>

#include "priors/constants.h"
#include "priors/spline/smoother.h"

namespace chladni::priors {

/// Smoothness of the heat kernel.
inline constexpr double kInfinitelySmooth = std::numeric_limits<double>::infinity();
/// Smoothness of shapes that have a slope across the free rims of their surface, see below.

/// S_j, the variances of a field's coefficients on the harmonics −Δ u_j = μ_j u_j, scaled to a mean
/// variance of 1 over the surface. Finite ν gives the Matern field of smoothness ν,
/// S ∝ (2ν/l² + μ)^−(ν+1); infinite ν the heat kernel, S ∝ exp(−l² μ / 2). On a plane far from its
/// rims they are the Matern and the squared exponential kernel of length l (Lindgren, Rue and
/// Lindstrom 2011; Borovitskiy et al. 2020). At a free rim the harmonics have no slope across it,
/// but a bending plate has. The coefficients of such a shape fall as 1/μ, like the deviations for
/// ν = 1. Smoother fields have too narrow bands near the rims: on eight modes of a slotted plate
/// the bands held 54 % of the truth with ν = 2.5, 95 % with ν = 1. Fields of few harmonics have
/// them too: on a coarser mesh 80, 100 and 150 harmonics gave 90, 92 and 94 %.
/// @param eigenvalue   h: μ [1/m²]
/// @param mean_square  h: of each harmonic over the surface
/// @param length       l [m]
/// @throws InvalidInput  length or ν is not positive
[[nodiscard]] Eigen::VectorXd harmonic_variances(const Eigen::VectorXd& eigenvalue,
                                                 const Eigen::VectorXd& mean_square, double length,
                                                 double smoothness = Constants::rim_smoothness);

/// k(x, x') = Σ_j S_j u_j(x) u_j(x'). @param a  N×h, @param b  n×h: the harmonics; @returns N×n
/// @throws InvalidInput  the number of harmonics and of variances differ
[[nodiscard]] Eigen::MatrixXd surface_covariance(const Eigen::VectorXd& variances,
                                                 const Eigen::MatrixXd& a,
                                                 const Eigen::MatrixXd& b);

/// The model of one shape: an unknown constant plus a field of this length and amplitude.
struct SurfaceFit {
  double length = 0.0;        ///< [m]
  bool at_bound = false;      ///< of the range of lengths
  Eigen::VectorXd variances;  ///< h: S of that length
  Eigen::VectorXd noise;      ///< s: relative to the noise of the smoothing
  Smoothing smoothing;        ///< amplitude² = noise² / λ; infinite λ: only the constant
};

/// The length and amplitude of greatest restricted likelihood, with the stated noise. The
/// search takes 32 lengths between the resolution of the finest harmonic, 2/√μ_h, and the
/// surface's own length, 2π/√μ_1. One decomposition per length gives the amplitude (Smoother).
/// Cost: 32 (10 s³ + s² h).
/// @param values, noise  s; @param harmonics  s×h, h > 1
/// @throws InvalidInput  sizes differ, all harmonics are constant
[[nodiscard]] SurfaceFit surface_fit(const Eigen::VectorXd& values, const Eigen::VectorXd& noise,
                                     const Eigen::MatrixXd& harmonics,
                                     const Eigen::VectorXd& eigenvalue,
                                     const Eigen::VectorXd& mean_square,
                                     double smoothness = Constants::rim_smoothness);

/// The smoother of such a fit, for places with these harmonics (s×h).
[[nodiscard]] Smoother surface_smoother(const SurfaceFit& fit, const Eigen::MatrixXd& harmonics);

}  // namespace chladni::priors
