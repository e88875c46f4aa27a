// Triangles of a plane figure.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace chladni::mesh {

/// A straight line between two points on the rim of a figure. `uses` is 1 where the figure is on
/// one side of the line, 2 where it is on both sides.
struct Line2 {
  int from = 0, to = 0, uses = 1;
};

/// Counter-clockwise Delaunay triangles (rows of `points`) of the figure with the rim `lines`
/// (including the rims of holes). There are no new points. No result where lines cross or points
/// coincide.
/// Cost: n log n.
[[nodiscard]] std::optional<std::vector<Eigen::Vector3i>> flat_triangles(
    const std::vector<Eigen::Vector2d>& points, const std::vector<Line2>& lines);

}  // namespace chladni::mesh
