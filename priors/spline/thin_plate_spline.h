// The thin plate of least bending through noisy values (thesis, 5.4.1 and appendix A).
#pragma once

#include <optional>

#include "priors/interpolator.h"
#include "priors/spline/smoother.h"

namespace chladni::priors {

/// The domain of the spline: the plane normal to the measured direction, or a line if the places
/// lie on one (a beam).
struct SplineDomain {
  Eigen::Vector3d direction;  ///< unit
  Eigen::Vector3d origin;     ///< [m]: the middle of the places
  Eigen::MatrixXd axes;       ///< 3×2 or 3×1, orthonormal
  double size = 1.0;          ///< [m]: root mean square distance of the places from the origin

  [[nodiscard]] Eigen::Index dimensions() const { return axes.cols(); }
};

/// @throws InvalidInput  directions that are not parallel (the sense is free); all places at one
///                       point of the plane
[[nodiscard]] SplineDomain spline_domain(const Places& places);

/// n×2 or n×1: coordinates along the domain's axes, divided by its size.
[[nodiscard]] Eigen::MatrixXd coordinates(const SplineDomain& domain, const Points& positions);

/// ±1 per place: the sense of its measurement along `direction` (unit).
/// @throws InvalidInput  a direction that is not parallel to it
[[nodiscard]] Eigen::VectorXd senses(const Eigen::Vector3d& direction, const Points& directions);

/// r² ln r / 8π between the rows of a and b in two dimensions, r³/12 in one: Δ² (the fourth
/// derivative) maps it to a point load. For weights with Σ c = 0 and Σ c x = 0 (A.5) the function
/// Σ c_j k(x, x_j) has the bending energy ∫ Wxx² + 2 Wxy² + Wyy² = cᵀ K c over the whole plane.
/// @param a  N×d; @param b  n×d; @returns N×n. Cost: one logarithm each.
[[nodiscard]] Eigen::MatrixXd bending_kernel(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// The functions 1, x (and y): n×(1 + d). They have no bending energy.
[[nodiscard]] Eigen::MatrixXd plane_functions(const Eigen::MatrixXd& coordinates);

struct SplineOptions {
  SmoothingRule rule = SmoothingRule::reml_known_noise;
  /// λ of (5.11) instead of a rule. Its sum is over ((W − z)/ν)², with ν the noise over its
  /// geometric mean: 1 if all places have equal noise. [m²] on a plane, [m³] on a line.
  std::optional<double> lambda;
};

/// Minimises Σ ((W(x_j) − z_j)/ν_j)² + λ ∫ Wxx² + 2 Wxy² + Wyy² for each mode. The source has an
/// unsquared Laplacian in (5.11) and (A.2), but its Green's functions minimise this. Its matrix
/// (A.7) is regular if the places are not on one line and either λ > 0 or no two coincide. Its λ is
/// 8π times ours. Lengths are scaled before r² ln r: a unit of length only adds multiples of r²,
/// which the conditions (A.5) turn into a plane, but it spoils the conditioning and changes λ.
///
/// The deviation is that of the equivalent Bayesian model (Wahba 1978): an unknown plane, and
/// bending as a Gaussian process of variance noise²/λ. The noise is the stated one (REML with known
/// noise, or λ given) or the learned one (the other rules).
/// @throws InvalidInput  fewer than three places; directions or places as in spline_domain
[[nodiscard]] std::unique_ptr<ModeField> thin_plate_spline(const MeasuredShapes& measured,
                                                           const SplineOptions& options = {});

}  // namespace chladni::priors
