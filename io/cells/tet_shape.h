// Is a quadratic or cubic tetrahedron of a file shaped as its node order says?
#pragma once

#include "base/arrays.h"

namespace chladni::io {

constexpr double kLargestCoordinate = 1e50;  ///< cubes of it are still finite

/// Reverses the orientation of one cell, a row of 4, 10 or 20 nodes in VTK's order, in place: its
/// first two corners change places, and what lies on the edges and faces goes with them.
void turn_inside_out(
    Eigen::Ref<Eigen::Matrix<std::int32_t, 1, Eigen::Dynamic, Eigen::RowMajor>> cell);

/// How far a node of the cell (10×3 or 20×3) lies from its place on the straight edge or flat face,
/// over the longest edge of the corners; the largest of all nodes.
[[nodiscard]] double largest_offset(const Points& nodes);

/// The smallest determinant of dx/dξ, over the largest, at the corners of the four-point Gauss rule
/// and the centroid; ≤ 0 where the cell folds over. 10×3 or 20×3.
[[nodiscard]] double smallest_jacobian(const Points& nodes);

}  // namespace chladni::io
