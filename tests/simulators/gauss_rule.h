// Gauss' rule on the shapes that simulators integrate over.
#pragma once

#include <Eigen/Core>

namespace chladni::simulators {

/// Σ weight f(point) = ∫ f over [−1, 1], exact for polynomials of degree 2 n − 1.
struct LineRule {
  Eigen::VectorXd point, weight;  ///< n
};
/// From the eigenvalues of Jacobi's matrix (Golub and Welsch 1969).
[[nodiscard]] LineRule gauss_rule(int points);

/// Σ area f(place) = ∫ f dA.
struct AreaRule {
  Eigen::MatrixX2d places;  ///< k×2 [m]
  Eigen::VectorXd area;     ///< k [m²]
};
/// points × points.
[[nodiscard]] AreaRule rectangle_rule(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                                      int points);

/// What of a disc lies on the rectangle |x| <= half.x, |y| <= half.y: points × points on each
/// sector between two kinks of its rim, four sectors where it has none.
/// @pre the centre lies on the rectangle
[[nodiscard]] AreaRule disc_rule(const Eigen::Vector2d& centre, double radius,
                                 const Eigen::Vector2d& half, int points);

/// A straight band of this width about the line.
[[nodiscard]] AreaRule band_rule(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                 double width, int along, int across);

}  // namespace chladni::simulators
