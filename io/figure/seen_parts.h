// Where the parts of a surface are seen on paper, so that names can stand on them.
#pragma once

#include <vector>

#include "base/arrays.h"

namespace chladni::io {

/// The place of a part that is nearly as far from what does not belong to it as any of its places,
/// nearest to the middle of what is seen of it.
struct SeenPart {
  double area = 0.0;    ///< that is seen of it, on paper [m²]; 0: it is hidden
  Eigen::Vector2d at;   ///< on paper: x to the right, y up [m]
  double radius = 0.0;  ///< of the disc around `at` in which nothing else is seen, about [m]
};

/// By a picture of `pixels` along the longer side in which the nearest triangle counts.
/// @param points     V×3 in the paper's frame: x right, y up, z towards the eye [m]
/// @param triangles  T×3
/// @param part       T: of each triangle, from 0
/// @throws InvalidInput  the arrays do not fit together, or pixels is less than 2
/// Cost: linear in triangles and pixels².
[[nodiscard]] std::vector<SeenPart> seen_parts(const Points& points, const Cells& triangles,
                                               const Eigen::VectorXi& part, int parts,
                                               int pixels = 900);

}  // namespace chladni::io
