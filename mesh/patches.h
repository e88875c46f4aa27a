// Finds and names the patches of a boundary that has no names, and tells which of them bound the
// body.
#pragma once

#include <vector>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Finds and names the patches of a surface without names, as `name_patches` of a TetMesh does
/// (mesh/tet_mesh.h). Cost: n log n. @throws InvalidInput  the angle is not between 0 and 180
void name_patches(Surface& surface, double angle_degrees = 40.0);

/// Per patch of `surface` 1 where it bounds the body, 0 where it has no triangle or all of them lie
/// between two regions. A region that another one surrounds counts as a void if no point of it is
/// in `surface.regions`. Cost: n log n.
[[nodiscard]] std::vector<char> bounding_patches(const Surface& surface);

}  // namespace chladni::mesh
