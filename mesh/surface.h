// Closed triangle surfaces: the form of a body before tetrahedralisation.
#pragma once

#include <string>
#include <vector>

#include "base/arrays.h"

namespace chladni::mesh {

/// A part of the body's inside. The mesher fills it from `inside` up to the triangles around it.
struct Region {
  std::string name;
  Eigen::Vector3d inside;  ///< any point of the region, not on its surface [m]
};

/// Triangles that bound a body, counter-clockwise seen from outside. With several regions, the
/// triangles between two regions occur once, in either orientation.
struct Surface {
  Points points;                         ///< N×3 [m]
  Cells triangles;                       ///< T×3
  Eigen::VectorXi patch;                 ///< T, index into patch_names
  std::vector<std::string> patch_names;  ///< "top", "bottom", "x_min", ..., or from the file
  std::vector<Region> regions;           ///< empty: one region, all the inside
};

/// The enclosed volume [m^3] by the divergence theorem. The orientation of the triangles is used as
/// it is; the volume is negative when the surface is inside out.
[[nodiscard]] double enclosed_volume(const Surface& surface);

/// The area of all triangles together [m^2]. A face of order 2 or 3 counts as the flat triangle of
/// its corners.
[[nodiscard]] double area(const Points& points, const Cells& triangles);

/// Smallest and largest coordinates, two rows [m].
[[nodiscard]] Eigen::Matrix<double, 2, 3, Eigen::RowMajor> bounding_box(const Points& points);

}  // namespace chladni::mesh
