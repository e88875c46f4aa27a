// Closed triangle surfaces: what a body looks like before it is cut into tetrahedra.
#pragma once

#include <string>
#include <vector>

#include "base/arrays.h"

namespace chladni::mesh {

/// A part of the inside: the mesher floods it from `inside` up to the triangles around it.
struct Region {
  std::string name;
  Eigen::Vector3d inside;  ///< any point of it, not on its surface [m]
};

/// Triangles that bound a body, seen from outside counter-clockwise. With several regions the
/// triangles between two of them are there once, in either orientation.
struct Surface {
  Points points;                         ///< N×3 [m]
  Cells triangles;                       ///< T×3
  Eigen::VectorXi patch;                 ///< T, index into patch_names
  std::vector<std::string> patch_names;  ///< "top", "bottom", "x_min", ..., or from the file
  std::vector<Region> regions;           ///< empty: one region, all the inside
};

/// Volume enclosed [m^3] by the divergence theorem, the outer boundary taken as oriented; negative
/// when inside out.
[[nodiscard]] double enclosed_volume(const Surface& surface);

/// Of all triangles together [m^2]; of a face of order 2 or 3 the flat of its corners counts.
[[nodiscard]] double area(const Points& points, const Cells& triangles);

/// Smallest and largest coordinates, two rows [m].
[[nodiscard]] Eigen::Matrix<double, 2, 3, Eigen::RowMajor> bounding_box(const Points& points);

}  // namespace chladni::mesh
