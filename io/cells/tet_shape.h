// Checks whether the shape of a quadratic or cubic tetrahedron from a file fits its node order.
#pragma once

#include "base/arrays.h"

namespace chladni::io {

constexpr double kLargestCoordinate = 1e50;  ///< its cube is still finite

/// Reverses the orientation of one cell in place. The cell is a row of 4, 10 or 20 nodes in VTK's
/// order. The first two corners are exchanged, and the nodes on edges and faces accordingly.
void turn_inside_out(
    Eigen::Ref<Eigen::Matrix<std::int32_t, 1, Eigen::Dynamic, Eigen::RowMajor>> cell);

/// The largest distance of a node of the cell (10×3 or 20×3) from its place on the straight edge or
/// flat face, divided by the longest edge of the corners.
[[nodiscard]] double largest_offset(const Points& nodes);

/// The smallest determinant of dx/dξ divided by the largest, at the points of the four-point Gauss
/// rule and the centroid. It is ≤ 0 where the cell folds over. `nodes` is 10×3 or 20×3.
[[nodiscard]] double smallest_jacobian(const Points& nodes);

}  // namespace chladni::io
