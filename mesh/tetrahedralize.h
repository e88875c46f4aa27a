// From a closed surface to tetrahedra, by TetGen in a worker program of its own.
#pragma once

#include <chrono>

#include "base/progress.h"
#include "mesh/check.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

struct MesherOptions {
  double edge_length = 0.0;          ///< wanted [m]; 0: `default_edge_length`
  double largest_radius_edge = 1.6;  ///< TetGen's -q
  double smallest_dihedral_degrees = 10.0;
  bool remesh_surface = true;  ///< fewest triangles on planes, isotropic ones where it is curved;
                               ///< edges sharper than 30 deg stay
  std::chrono::seconds time_limit{300};
  std::size_t memory_limit_bytes = std::size_t{8} << 30U;
};

/// A length for cubic cells: the smaller of a 30th of the largest extent and the typical wall
/// (2 volume / area) times 2.2, but no more than 1e6 cells' worth [m]. At the factor 2.2 frequencies
/// are within 0.2 % on plates, 0.25 % in the torsion of a strip, and of a table with open ribs about
/// 1.3 % in the first twist (singular inner edges), 0.5 % in the others.
[[nodiscard]] double default_edge_length(const Surface& surface);

/// Linear tetrahedra of `surface`, whose patches are the mesh's; nodes sorted in space.
/// The volume is compared with the surface's, every cell is checked.
/// @throws InvalidInput   the surface is not fit (the report's text)
/// @throws WorkerDied     TetGen aborted, crashed, hung or ran out of memory, with what to do
/// @throws NumericalFailure  it returned no or too little volume
[[nodiscard]] TetMesh tetrahedralize(const Surface& surface, const MesherOptions& options,
                                     const Progress& progress = {});

}  // namespace chladni::mesh
