// Mode shapes as polynomials, for a controller without a mesh.
#pragma once

#include "priors/interpolator.h"

namespace chladni::priors {

/// Σ a_pq T_p(u) T_q(v), p + q <= degree; T are Chebyshev polynomials of the first kind, u and v
/// the coordinates in the plane, scaled to [−1, 1].
struct ShapePolynomials {
  int degree = 0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero(), half_width = Eigen::Vector2d::Ones();  ///< [m]
  Eigen::MatrixXi powers;         ///< c×2: p and q of each coefficient
  Eigen::MatrixXd coefficients;   ///< c×m, in the unit of the shapes
  Eigen::VectorXd rms_error;      ///< m: over the points, relative to the shape's root mean square
  Eigen::VectorXd largest_error;  ///< m: the same for the largest error
};

/// Weighted least squares over points. @param at  n×2 [m]; @param area  n; @param shapes  n×m
/// Cost: n c². @throws InvalidInput  fewer points than coefficients, or no extent along an axis
[[nodiscard]] ShapePolynomials polynomials(const Eigen::MatrixX2d& at, const Eigen::VectorXd& area,
                                           const Eigen::MatrixXd& shapes, int degree);

/// n×m. @param at  n×2 [m]
[[nodiscard]] Eigen::MatrixXd values(const ShapePolynomials& polynomials,
                                     const Eigen::MatrixX2d& at);

}  // namespace chladni::priors
