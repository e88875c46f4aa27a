// Two ways to one mesh.
#pragma once

#include <functional>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// The mesh of `first` where its smallest dihedral angle is at least `good_enough` [degrees], else
/// that of the two with the larger one. Where one way fails the other one's mesh is taken.
/// @throws  what `second` threw where both fail; OutOfResources and Interrupted of either at once
[[nodiscard]] TetMesh better_mesh(const std::function<TetMesh()>& first,
                                  const std::function<TetMesh()>& second, double good_enough);

}  // namespace chladni::mesh
