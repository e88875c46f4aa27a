// Where a soup of triangles is not the boundary of a body.
#pragma once

#include <optional>
#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// Edges with one triangle only that hang together.
struct Hole {
  std::vector<int> points;  ///< in order along the loop when it is simple
  int edges = 0;
  bool simple = false;     ///< one loop that passes through each of its points once
  Eigen::Vector3d centre;  ///< mean of its points [m]
};
/// By falling number of edges. Cost: n log n, as all here.
[[nodiscard]] std::vector<Hole> holes(const Surface& surface);

/// Edges (two points) with more than two triangles.
[[nodiscard]] std::vector<Eigen::Vector2i> crowded_edges(const Surface& surface);

/// Points whose triangles hang together by the point only, not by edges.
[[nodiscard]] std::vector<int> pinched_points(const Surface& surface);

/// Two triangles that share more of their insides than a common edge or point.
struct Crossing {
  int first = 0, second = 0;  ///< triangles, first < second
  Eigen::Vector3d place;      ///< the middle of what both bounding boxes cover [m]
};
/// By rising triangle numbers; exact predicates; no triangle may be degenerate.
[[nodiscard]] std::vector<Crossing> crossings(const Surface& surface);

/// Triangles (rows of `points`) that close a simple loop of `points`. Empty when there are none.
[[nodiscard]] std::vector<Eigen::Vector3i> filling(const Surface& surface,
                                                   const std::vector<int>& loop);

/// `surface` with isotropic triangles of `edge_length` [m], one per patch, 0 for those that are
/// left as they are. The edges of `kept`, those between patches and those with other than two
/// triangles stay, and so do their points; triangles of one patch are resampled on themselves. None
/// where the triangles of two neighbours run against each other, or where an edge that stays is
/// longer than 4/3 of what its triangles are to have.
[[nodiscard]] std::optional<Surface> isotropic(const Surface& surface,
                                               const std::vector<Eigen::Vector2i>& kept,
                                               const std::vector<double>& edge_length);

}  // namespace chladni::mesh
