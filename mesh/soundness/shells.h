// The closed shells that a soup of triangles forms, and which side of each triangle is material.
#pragma once

#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// One triangle's use of an edge.
struct EdgeUse {
  int low = 0, high = 0;  ///< its ends, low < high
  int triangle = 0;
  int opposite = 0;      ///< the triangle's third point
  bool forward = false;  ///< the triangle runs from low to high
};

/// Three per triangle, sorted by (low, high, triangle). Cost: n log n.
[[nodiscard]] std::vector<EdgeUse> edge_uses(const Cells& triangles);

/// The first use beyond those of the edge that begins at `first`.
[[nodiscard]] std::size_t end_of_edge(const std::vector<EdgeUse>& uses, std::size_t first);

/// Each triangle has a front (where its normal points) and a back. Sides that see each other across
/// an edge belong to one shell; how the triangles happen to be oriented does not matter.
struct Shells {
  std::vector<int> front, back;  ///< per triangle: the shell that this side belongs to
  std::vector<double> volume;  ///< per shell [m^3]: positive around what it sees, negative when it
                               ///< sees the space outside of it
  std::vector<int> component;  ///< per triangle: triangles joined by edges
  int component_count = 0;
};
[[nodiscard]] Shells shells(const Surface& surface);

/// Where there is material. A shell inside another one is a void, one inside a void is a body, and
/// so on; but a shell that holds the seed of a region is material.
struct Material {
  struct Body {              // those that do not touch each other
    double volume = 0.0;     ///< without its voids [m^3]
    Eigen::Vector3d centre;  ///< of its bounding box [m]
  };
  std::vector<char> front, back;  ///< per triangle: 1 where that side is material
  std::vector<Body> bodies;
  int void_count = 0;   ///< voids that are closed in on all sides
  double volume = 0.0;  ///< [m^3]

  /// Triangle t is between material and none.
  [[nodiscard]] bool outer(std::size_t t) const { return front[t] != back[t]; }
};
/// Expects a closed surface. Cost: linear, times the shells that may lie in each other.
[[nodiscard]] Material material(const Surface& surface, const Shells& of);

/// How often the triangles wind around `point`, each as oriented (sign 1), turned (−1) or left out
/// (0): 1 inside, 0 outside of a closed surface seen counter-clockwise. Cost: linear.
[[nodiscard]] double winding_number(const Surface& surface, const std::vector<int>& sign,
                                    const Eigen::Vector3d& point);

}  // namespace chladni::mesh
