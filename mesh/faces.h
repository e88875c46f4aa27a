// Boundary faces of a mesh: those of named patches, and the small triangles between their nodes.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// The 1, 4 or 9 triangles between the nodes of a face of `order` 1, 2 or 3. Nodes are in VTK's
/// order. All triangles have the face's orientation.
[[nodiscard]] std::span<const std::array<int, 3>> face_triangles(int order);

/// The first patch with this name. @param what  the caller, for the message
/// @throws InvalidInput  there is no such patch (lists the existing ones)
[[nodiscard]] int patch_number(const TetMesh& mesh, const std::string& name,
                               const std::string& what);

/// 1 for each patch whose name is among `names`. Empty `names` chooses all patches.
/// @throws InvalidInput  as patch_number
[[nodiscard]] std::vector<char> chosen_patches(const TetMesh& mesh,
                                               const std::vector<std::string>& names,
                                               const std::string& what);

/// 1 for each boundary face whose patch is among `names`. Empty `names` chooses all faces.
/// @throws InvalidInput  as patch_number
[[nodiscard]] std::vector<char> faces_of_patches(const TetMesh& mesh,
                                                 const std::vector<std::string>& names,
                                                 const std::string& what);

}  // namespace chladni::mesh
