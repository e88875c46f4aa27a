// Finds the visible places of the parts of a surface on paper, so that names can stand there.
#pragma once

#include <vector>

#include "base/arrays.h"

namespace chladni::io {

/// The best place for a name on a part. Of the places with nearly the largest distance from other
/// parts, it is the one nearest to the middle of the visible area.
struct SeenPart {
  double area = 0.0;    ///< visible area on paper [m²]; 0: the part is hidden
  Eigen::Vector2d at;   ///< on paper: x to the right, y up [m]
  double radius = 0.0;  ///< of the disc around `at` that shows only this part, about [m]
};

/// Finds the places in a picture of `pixels` along the longer side. In each pixel the triangle
/// nearest to the eye counts.
/// @param points     V×3 in the paper's frame: x right, y up, z towards the eye [m]
/// @param triangles  T×3
/// @param part       T: of each triangle, from 0
/// @throws InvalidInput  the arrays do not fit together, or pixels is less than 2
/// Cost: linear in triangles and pixels².
[[nodiscard]] std::vector<SeenPart> seen_parts(const Points& points, const Cells& triangles,
                                               const Eigen::VectorXi& part, int parts,
                                               int pixels = 900);

}  // namespace chladni::io
