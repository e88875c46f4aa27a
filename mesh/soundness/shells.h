// The closed shells of a soup of triangles, and the material side of each triangle.
#pragma once

#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// One triangle's use of an edge.
struct EdgeUse {
  int low = 0, high = 0;  ///< the ends of the edge, low < high
  int triangle = 0;
  int opposite = 0;      ///< the triangle's third point
  bool forward = false;  ///< the triangle runs from low to high
};

/// Three per triangle, sorted by (low, high, triangle). Cost: n log n.
[[nodiscard]] std::vector<EdgeUse> edge_uses(const Cells& triangles);

/// Index of the first use after the uses of the edge that starts at `first`.
[[nodiscard]] std::size_t end_of_edge(const std::vector<EdgeUse>& uses, std::size_t first);

/// The shells of a surface. Each triangle has a front (where its normal points) and a back. Sides
/// that face each other across an edge belong to one shell. The orientation of the triangles does
/// not matter.
struct Shells {
  std::vector<int> front, back;  ///< per triangle: the shell that this side belongs to
  std::vector<double> volume;  ///< per shell [m^3]: positive when its sides face the space inside
                               ///< it, negative when they face the space outside it
  std::vector<int> component;  ///< per triangle: triangles joined by edges
  int component_count = 0;
};
[[nodiscard]] Shells shells(const Surface& surface);

/// Where there is material. A shell inside another shell is a void, a shell inside a void is a
/// body, and so on. But a shell that contains the seed of a region is material.
struct Material {
  struct Body {              // bodies do not touch each other
    double volume = 0.0;     ///< without its voids [m^3]
    Eigen::Vector3d centre;  ///< of its bounding box [m]
  };
  std::vector<char> front, back;  ///< per triangle: 1 where that side is material
  std::vector<Body> bodies;
  int void_count = 0;   ///< voids that are closed on all sides
  double volume = 0.0;  ///< [m^3]

  /// Whether triangle t has material on one side only.
  [[nodiscard]] bool outer(std::size_t t) const { return front[t] != back[t]; }
};
/// The material of a closed surface. Cost: linear, times the number of shells that may contain each
/// other.
[[nodiscard]] Material material(const Surface& surface, const Shells& of);

/// How often the triangles wind around `point`. Each triangle counts as it is oriented (sign 1),
/// turned (−1) or not at all (0). The number is 1 inside and 0 outside a closed surface whose
/// triangles are counter-clockwise seen from outside. Cost: linear.
[[nodiscard]] double winding_number(const Surface& surface, const std::vector<int>& sign,
                                    const Eigen::Vector3d& point);

}  // namespace chladni::mesh
