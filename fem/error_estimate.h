// How far the mesh leaves a frequency above the converged one.
#pragma once

#include <vector>

#include "fem/material.h"
#include "fem/system.h"
#include "mesh/tet_mesh.h"
#include "modal/modes.h"

namespace chladni::fem {

/// Relative error (f − f_exact) / f of each flexible frequency, 0 for the rigid-body modes.
///
/// On every tetrahedron the residual of the mode, with the tractions of both sides of a face
/// averaged, is tested with the polynomials one order higher that vanish at the element's nodes;
/// the energy of the local solutions estimates that of the error, which is the error of ω². A mode
/// of its own needs no second mesh and is told where the others are not. Curved cells are
/// integrated as they are; how far they lie from the true surface is not seen.
///
/// @param modes  shapes on the free degrees of freedom of `system`
/// Cost: linear in the cells; a few seconds per 10^5 cells and 20 modes. Memory: 130 bytes per
/// cell, whatever the number of modes.
/// @throws Interrupted
/// Source: Bank and Weiser (1985), Math. Comp. 44, 283-301; for eigenvalues Larson (2000), SIAM J.
/// Numer. Anal. 38, 608-625.
[[nodiscard]] Eigen::VectorXd frequency_error(const mesh::TetMesh& body,
                                              const std::vector<Material>& materials,
                                              const System& system, const modal::Modes& modes);

/// What it takes of memory beside the system and the shapes, of so many tetrahedra [bytes].
[[nodiscard]] constexpr double frequency_error_bytes(double tets) { return 130.0 * tets; }

}  // namespace chladni::fem
