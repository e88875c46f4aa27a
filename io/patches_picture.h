// A picture of the patches of a body: what a study may name in `on`, `keep_out` and supports.
#pragma once

#include <filesystem>
#include <string>

#include "mesh/tet_mesh.h"

namespace chladni::io {

/// The body from two opposite sides, its patches in colours that differ from those of their
/// neighbours. On each stands its name, or where that has no room its number, counted from 1 in the
/// order of the mesh's patch_names; numbers, names and areas below, of the 120 largest at most.
/// PNG, 1400 px wide; the same input gives the same bytes. About 1 s.
/// @throws InvalidInput  the mesh has no boundary, or it has no patches
/// @throws WorkerDied    as draw_modes
void draw_patches(const std::filesystem::path& png, const mesh::TetMesh& mesh,
                  const std::string& title);

}  // namespace chladni::io
