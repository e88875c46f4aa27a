// The Gauss rule on the shapes over which simulators integrate.
#pragma once

#include <Eigen/Core>

namespace chladni::simulators {

/// Σ weight f(point) = ∫ f over [−1, 1], exact for polynomials of degree 2 n − 1.
struct LineRule {
  Eigen::VectorXd point, weight;  ///< n
};
/// The rule from the eigenvalues of the Jacobi matrix (Golub and Welsch 1969).
[[nodiscard]] LineRule gauss_rule(int points);

/// Σ area f(place) = ∫ f dA.
struct AreaRule {
  Eigen::MatrixX2d places;  ///< k×2 [m]
  Eigen::VectorXd area;     ///< k [m²]
};
/// The rule on a rectangle with points × points.
[[nodiscard]] AreaRule rectangle_rule(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                                      int points);

/// The rule on the part of a disc on the rectangle |x| <= half.x, |y| <= half.y. Each sector
/// between two kinks of the rim has points × points; there are four sectors where the rim has no
/// kink.
/// @pre the centre lies on the rectangle
[[nodiscard]] AreaRule disc_rule(const Eigen::Vector2d& centre, double radius,
                                 const Eigen::Vector2d& half, int points);

/// The rule on a straight band of this width about the line.
[[nodiscard]] AreaRule band_rule(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                 double width, int along, int across);

}  // namespace chladni::simulators
