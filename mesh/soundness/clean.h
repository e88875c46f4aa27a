// What can be mended in a soup of triangles without changing the body it means.
#pragma once

#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// Lengths below this are none: a billionth of the bounding box's diagonal [m].
[[nodiscard]] double smallest_length(const Surface& surface);

/// Each of these mends in place, keeps the order of what stays and returns how many were removed.
int merge_points(Surface& surface, double tolerance);  ///< those within `tolerance` [m]
int remove_duplicate_triangles(Surface& surface);      ///< of the same points in any order
int remove_unused_points(Surface& surface);
/// Triangles that use a point twice or are lower than `tolerance` [m]; where a point lies on the
/// longest edge of such a triangle, the neighbours across that edge are split there, so that a
/// closed surface stays closed.
int remove_degenerate_triangles(Surface& surface, double tolerance);

/// Appends triangles (rows of points) with their patches.
void append_triangles(Surface& surface, const std::vector<Eigen::Vector3i>& triangles,
                      const std::vector<int>& patches);

}  // namespace chladni::mesh
