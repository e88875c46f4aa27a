// K and M of a body of tetrahedra, with what is attached to it.
#pragma once

#include <vector>

#include "fem/attachment.h"
#include "fem/material.h"
#include "fem/system.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {

/// The system of `body`: consistent mass, straight-sided elements in closed form (curved ones by
/// quadrature), summed straight into compressed form on all cores. The same bits for any number of
/// threads. Cost: linear; about 0.3 CPU s for 10^5 degrees of freedom of tet10.
///
/// @param materials    one per region of the body
/// @throws InvalidInput  a region has no material, a cell is inverted or flat at a point where it
/// is
///                       integrated (says which), a patch of a support does not exist, a mass or
///                       stiffness is negative or not finite
/// @throws Interrupted
[[nodiscard]] System assemble(const mesh::TetMesh& body, const std::vector<Material>& materials,
                              const std::vector<Support>& supports = {},
                              const std::vector<Attachment>& attachments = {});

/// Of the body and its point masses and resonators, from the geometry, not from M.
[[nodiscard]] MassProperties mass_properties(const mesh::TetMesh& body,
                                             const std::vector<Material>& materials,
                                             const std::vector<Attachment>& attachments = {});

}  // namespace chladni::fem
