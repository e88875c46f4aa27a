// Repairs a soup of triangles without changing the intended body.
#pragma once

#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// Smaller lengths count as 0: a billionth of the bounding box's diagonal [m].
[[nodiscard]] double smallest_length(const Surface& surface);

/// Each of these repairs in place, keeps the order of the rest and returns the number removed.
int merge_points(Surface& surface, double tolerance);  ///< points within `tolerance` [m]
int remove_duplicate_triangles(Surface& surface);      ///< same points in any order
int remove_unused_points(Surface& surface);
/// Removes triangles that use a point twice or whose height is below `tolerance` [m]. Where a
/// corner lies on the longest edge of such a triangle, the neighbours across this edge are split at
/// the corner, so that a closed surface stays closed.
int remove_degenerate_triangles(Surface& surface, double tolerance);

/// Appends triangles (rows of points) with their patches.
void append_triangles(Surface& surface, const std::vector<Eigen::Vector3i>& triangles,
                      const std::vector<int>& patches);

}  // namespace chladni::mesh
