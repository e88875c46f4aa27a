// Chooses the better of two meshes of one body.
#pragma once

#include <functional>
#include <string>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// The mesh of `first` where its smallest dihedral angle is at least `good_enough` [degrees]. Else
/// `second` is tried too, and quality counts first, then size: `second` where it is good enough;
/// else the mesh with the larger smallest angle, or, where the two angles are within a quarter, the
/// one with fewer cells. Where one of them fails, the mesh of the other is returned.
/// @param on_death  is told why a worker died in one of them, where the mesh of the other is
///                  returned: an overloaded machine may be the reason, so the next run may differ
/// @throws  the exception of `second` where both fail; OutOfResources and Interrupted at once
[[nodiscard]] TetMesh better_mesh(const std::function<TetMesh()>& first,
                                  const std::function<TetMesh()>& second, double good_enough,
                                  const std::function<void(const std::string&)>& on_death = {});

}  // namespace chladni::mesh
