// The parts of a surface that lie in a plane, as triangles.
#pragma once

#include <optional>
#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// A straight line on the rim of a plane part, and on how many of its sides the part is, 1 or 2.
struct PlaneLine {
  int from = 0, to = 0, uses = 1;
};

/// Rows of area vectors, twice the area along the normal, summed over the triangles of each part.
[[nodiscard]] Points part_normals(const Surface& surface, const std::vector<int>& part);

/// Delaunay triangles (rows of `points`), seen against `normal` counter-clockwise, of the plane
/// part with this rim, through its points and those of `through`. None where the lines cross.
[[nodiscard]] std::optional<std::vector<Eigen::Vector3i>> plane_triangles(
    const Points& points, const std::vector<Eigen::Vector3i>& through,
    const std::vector<PlaneLine>& rim, const Eigen::RowVector3d& normal);

}  // namespace chladni::mesh
