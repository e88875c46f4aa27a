// The smooth parts of a surface between its sharp edges.
#pragma once

#include <vector>

#include "mesh/soundness/shells.h"
#include "mesh/surface.h"

namespace chladni::mesh {

/// Parts of triangles that are joined across edges that need not stay. An edge stays where the
/// patch or the plane differs, where it does not have two triangles, and where it is sharp.
struct SmoothParts {
  std::vector<int> part;       ///< per triangle
  std::vector<double> radius;  ///< per part [m]: 1 / (mean |k1 + k2|); infinite for flat parts
  std::vector<EdgeUse> kept;   ///< the first use of every edge that must stay, sorted by its ends

  [[nodiscard]] bool flat(int p) const;
};

/// Finds the smooth parts. A plane at least about as wide as `edge_length` [m] is one part, even if
/// it is made of slivers. The rest is divided along edges sharper than `sharp_degrees`. Cost:
/// n log n.
[[nodiscard]] SmoothParts smooth_parts(const Surface& surface, double edge_length,
                                       double sharp_degrees);

}  // namespace chladni::mesh
