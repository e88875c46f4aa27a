// Tetrahedra of a surface, meshed or taken from an earlier run that meshed the same.
#pragma once

#include "mesh/tetrahedralize.h"
#include "stage/work.h"

namespace chladni::stage {

/// mesh::tetrahedralize, whose result is kept in the cache of `work`, where it has one. What is
/// taken from there is checked as a mesh of a file is. Where the mesher died in one of its two
/// attempts, a note says so, and the mesh is not kept.
/// @throws as mesh::tetrahedralize; never because of what is kept
[[nodiscard]] mesh::TetMesh kept_mesh(const mesh::Surface& surface, mesh::MesherOptions options,
                                      Work& work);

}  // namespace chladni::stage
