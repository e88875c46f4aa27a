// Finds and names the patches of a boundary that has no names.
#pragma once

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Finds and names the patches of a surface without names, as `name_patches` of a TetMesh does
/// (mesh/tet_mesh.h). Cost: n log n. @throws InvalidInput  the angle is not between 0 and 180
void name_patches(Surface& surface, double angle_degrees = 40.0);

}  // namespace chladni::mesh
