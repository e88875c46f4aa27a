// What lies between the sharp edges of a surface.
#pragma once

#include <vector>

#include "mesh/soundness/shells.h"
#include "mesh/surface.h"

namespace chladni::mesh {

/// Triangles joined across edges that need not stay. An edge stays where the patch or the part
/// differs, where it has other than two triangles, and where it is sharp.
struct SmoothParts {
  std::vector<int> part;       ///< per triangle
  std::vector<double> radius;  ///< per part [m]: 1 / (mean |k1 + k2|); infinite where it is flat
  std::vector<EdgeUse> kept;   ///< the first use of every edge that must stay, sorted by its ends

  [[nodiscard]] bool flat(int p) const;
};

/// Planes at least about as wide as `edge_length` [m] are parts of their own, whatever slivers they
/// are made of; the rest is parted along edges sharper than `sharp_degrees`. Cost: n log n.
[[nodiscard]] SmoothParts smooth_parts(const Surface& surface, double edge_length,
                                       double sharp_degrees);

}  // namespace chladni::mesh
