// Boundary faces of a mesh: those of named patches, and the small triangles between their nodes.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// The 1, 4 or 9 triangles between the nodes of a face of `order` 1, 2 or 3, in VTK's order of
/// nodes, all turning as the face does.
[[nodiscard]] std::span<const std::array<int, 3>> face_triangles(int order);

/// The first patch of a name. @param what  asks for it, for the message
/// @throws InvalidInput  there is none (lists those there are)
[[nodiscard]] int patch_number(const TetMesh& mesh, const std::string& name,
                               const std::string& what);

/// Per patch 1 where its name is among `names`; all where there are no names.
/// @throws InvalidInput  as patch_number
[[nodiscard]] std::vector<char> chosen_patches(const TetMesh& mesh,
                                               const std::vector<std::string>& names,
                                               const std::string& what);

/// Per boundary face 1 where its patch is one of these; of all where there are no names.
/// @throws InvalidInput  as patch_number
[[nodiscard]] std::vector<char> faces_of_patches(const TetMesh& mesh,
                                                 const std::vector<std::string>& names,
                                                 const std::string& what);

}  // namespace chladni::mesh
