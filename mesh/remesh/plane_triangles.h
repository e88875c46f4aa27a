// The parts of a surface that lie in a plane, as triangles.
#pragma once

#include <optional>
#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// A straight line on the rim of a plane part. `uses` is the number of sides of the line, 1 or 2,
/// on which the part lies.
struct PlaneLine {
  int from = 0, to = 0, uses = 1;
};

/// For each part the sum of its triangles' area vectors (twice the area, along the normal), one row
/// per part.
[[nodiscard]] Points part_normals(const Surface& surface, const std::vector<int>& part);

/// Delaunay triangles (rows of `points`) of the plane part with this rim, counter-clockwise about
/// `normal`. They use the points of the rim and of `through`. No result where the lines cross.
[[nodiscard]] std::optional<std::vector<Eigen::Vector3i>> plane_triangles(
    const Points& points, const std::vector<Eigen::Vector3i>& through,
    const std::vector<PlaneLine>& rim, const Eigen::RowVector3d& normal);

}  // namespace chladni::mesh
