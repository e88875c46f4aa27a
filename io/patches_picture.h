// A picture of the patches of a body. A study names them in `on`, `keep_out` and supports.
#pragma once

#include <string>

#include "io/picture_file.h"
#include "mesh/tet_mesh.h"

namespace chladni::io {

/// Draws the body from two opposite sides. Neighbouring patches have different colours where
/// possible. Each patch carries its name, or its number where the name does not fit. Numbers count
/// from 1 in the order of the mesh's patch_names. A table below has numbers, names and areas of the
/// 120 largest patches at most. PNG, 1400 px wide; the same input gives the same bytes. About 1 s.
/// @throws InvalidInput  the mesh has no boundary, or it has no patches
/// @throws WorkerDied    as draw_modes
void draw_patches(const PictureFile& png, const mesh::TetMesh& mesh, const std::string& title);

}  // namespace chladni::io
