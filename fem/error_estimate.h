// Estimates how far a frequency on this mesh lies above the converged frequency.
#pragma once

#include <vector>

#include "fem/material.h"
#include "fem/system.h"
#include "mesh/tet_mesh.h"
#include "modal/modes.h"

namespace chladni::fem {

/// Relative error (f − f_exact) / f of each flexible frequency, 0 for the rigid-body modes.
///
/// On every tetrahedron the residual of the mode is tested with the polynomials of one order higher
/// that vanish at the element's nodes. The tractions of both sides of a face are averaged. The
/// energy of the local solutions estimates the energy of the error; with it Schwarz' quotient gives
/// the converged ω². Cells of order 2 that are much longer than thick solve their polynomials one
/// by one: together these bend far too softly. Each mode is estimated by itself, without a second
/// mesh. Curved cells are integrated as they are; the estimate does not include their distance from
/// the true surface. It is below 1, and mostly 1 to 3 times the error; it may be half of errors
/// above a tenth.
///
/// @param modes  shapes on the free degrees of freedom of `system`
/// Cost: linear in the cells; a few seconds per 10^5 cells and 20 modes. Memory: 130 bytes per
/// cell, for any number of modes.
/// @throws Interrupted
/// Source: Bank and Weiser (1985), Math. Comp. 44, 283-301; for eigenvalues Larson (2000), SIAM J.
/// Numer. Anal. 38, 608-625.
[[nodiscard]] Eigen::VectorXd frequency_error(const mesh::TetMesh& body,
                                              const std::vector<Material>& materials,
                                              const System& system, const modal::Modes& modes);

/// Memory that frequency_error needs beside the system and the shapes, for `tets` cells [bytes].
[[nodiscard]] constexpr double frequency_error_bytes(double tets) { return 130.0 * tets; }

}  // namespace chladni::fem
