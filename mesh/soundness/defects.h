// Finds the places where a soup of triangles is not the boundary of a body.
#pragma once

#include <optional>
#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// A hole: connected edges with only one triangle.
struct Hole {
  std::vector<int> points;  ///< in order along the loop when the hole is simple
  int edges = 0;
  bool simple = false;     ///< one loop that passes through each of its points once
  Eigen::Vector3d centre;  ///< mean of the points [m]
};
/// The holes by falling number of edges. Cost: n log n, as for all functions here.
[[nodiscard]] std::vector<Hole> holes(const Surface& surface);

/// Edges (two points) with more than two triangles.
[[nodiscard]] std::vector<Eigen::Vector2i> crowded_edges(const Surface& surface);

/// Points whose triangles form several fans that are connected by the point only, not by edges.
[[nodiscard]] std::vector<int> pinched_points(const Surface& surface);

/// Two triangles that intersect in more than a common edge or point.
struct Crossing {
  int first = 0, second = 0;  ///< triangles, first < second
  Eigen::Vector3d place;      ///< middle of the overlap of both bounding boxes [m]
};
/// The crossings by rising triangle numbers, with exact predicates. Degenerate triangles are left
/// out.
[[nodiscard]] std::vector<Crossing> crossings(const Surface& surface);

/// Triangles (rows of `points`) that close a simple loop of `points`. Empty when there are none.
[[nodiscard]] std::vector<Eigen::Vector3i> filling(const Surface& surface,
                                                   const std::vector<int>& loop);

/// `surface` with isotropic triangles of `edge_length` [m, one per patch; 0: the patch stays as it
/// is]. Three kinds of edges stay with their points: edges of `kept`, edges between patches, and
/// edges that do not have two triangles. New points lie on the old triangles of the patch. No
/// result where two neighbouring triangles that do not stay have opposite orientations, or where an
/// edge that stays is longer than 4/3 of the wanted length of its triangles.
[[nodiscard]] std::optional<Surface> isotropic(const Surface& surface,
                                               const std::vector<Eigen::Vector2i>& kept,
                                               const std::vector<double>& edge_length);

}  // namespace chladni::mesh
