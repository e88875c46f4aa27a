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
/// by one: together these bend far too softly. The energy is never less than a part of that of the
/// jumps of the tractions, which alone show what cells leave that span a bending wave. Each mode is
/// estimated by itself, without a second mesh. Curved cells are integrated as they are; the
/// estimate does not include their distance from the true surface.
///
/// It is below 1, and mostly 1 to 3 times the error (up to 10 times and more on tables with ribs).
/// It may be 0.6 of the error where one or two cells span the body, and in single modes of compact
/// bodies. It tells how far this mode lies above the same motion on finer meshes. Where errors
/// differ so much that modes change their order, as from a quarter on, the k-th mode is another
/// motion than the k-th of a finer mesh, and the difference of the two can be much more.
///
/// @param modes  shapes on the free degrees of freedom of `system`
/// Cost: linear in the cells; a few seconds per 10^5 cells and 20 modes. Memory: 130 bytes per
/// cell, for any number of modes.
/// @throws Interrupted
/// Source: Bank and Weiser (1985), Math. Comp. 44, 283-301; jumps: Babuška and Rheinboldt (1978),
/// SIAM J. Numer. Anal. 15, 736-754; for eigenvalues Larson (2000), SIAM J. Numer. Anal. 38,
/// 608-625.
[[nodiscard]] Eigen::VectorXd frequency_error(const mesh::TetMesh& body,
                                              const std::vector<Material>& materials,
                                              const System& system, const modal::Modes& modes);

/// Memory that frequency_error needs beside the system and the shapes, for `tets` cells [bytes].
[[nodiscard]] constexpr double frequency_error_bytes(double tets) { return 130.0 * tets; }

}  // namespace chladni::fem
