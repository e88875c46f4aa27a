// Triangles of a plane figure.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace chladni::mesh {

/// A straight line between two points, and how often the figure has it on its rim: 1 with the
/// figure on one side, 2 with the figure on both.
struct Line2 {
  int from = 0, to = 0, uses = 1;
};

/// Counter-clockwise Delaunay triangles (rows of `points`) of the figure whose rim are `lines`,
/// holes included, without new points. None where lines cross or points fall together.
/// Cost: n log n.
[[nodiscard]] std::optional<std::vector<Eigen::Vector3i>> flat_triangles(
    const std::vector<Eigen::Vector2d>& points, const std::vector<Line2>& lines);

}  // namespace chladni::mesh
