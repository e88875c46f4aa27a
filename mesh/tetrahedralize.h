// Meshes a closed surface with tetrahedra, by TetGen in a separate worker program.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "base/progress.h"
#include "mesh/check.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

struct MesherOptions {
  double edge_length = 0.0;                 ///< wanted [m]; 0: `default_edge_length`
  double largest_radius_edge = 1.6;         ///< TetGen's -q
  double smallest_dihedral_degrees = 10.0;  ///< less where the body is thinner than a fifth of
                                            ///< an edge: its cells cannot be less flat
  bool remesh_surface = true;  ///< first isotropic triangles; where the cells are too flat, also
                               ///< fewest triangles on planes, and the better mesh is taken; edges
                               ///< sharper than 30 deg stay
  /// Is told why the mesher died in one of the two attempts, where the mesh of the other is
  /// returned: it is perhaps the worse one, and may differ in the next run. Empty: nobody is.
  std::function<void(const std::string&)> on_death = {};
  std::chrono::seconds time_limit{300};
  std::size_t memory_limit_bytes = std::size_t{8} << 30U;
};

/// An edge length for cubic cells [m]: the smaller of a 30th of the largest extent and the typical
/// wall (2 volume / area) times 2.2, but long enough for at most about 1e6 cells. With the factor
/// 2.2 the errors of frequencies are within 0.2 % on plates and 0.25 % in the torsion of a strip.
/// On a table with open ribs they are about 1.3 % in the first twist (singular inner edges) and
/// 0.5 % in the other modes.
[[nodiscard]] double default_edge_length(const Surface& surface);

/// Numbers of cells and boundary triangles of TetGen on an isotropic surface, from volume [m^3] and
/// area [m^2]. Fitted to plates, a disc, a torus and a ribbed table, within a factor of 1.2. A part
/// thinner than an edge has only cells between the two sides of its surface.
struct CellCount {
  double tets, faces;
};
[[nodiscard]] CellCount expected_count(double volume, double area, double edge_length);

/// The same of a wall of `volume` [m^3] and `thickness` [m] on a thicker part, where the wall is so
/// thin that cells between its sides would be flatter than MesherOptions::smallest_dihedral_degrees
/// allows: the second attempt then makes cells as small as the wall is thick, however long the
/// wanted edge is. Fitted to wafers of a twelfth to an eighth of an edge, within a factor of 1.2.
/// {0, 0} for a wall of a seventh of an edge and more, and for a body that is thin as a whole:
/// its cells stay flat, and `expected_count` tells their number.
/// @param bonded_sides  of the wall, 0 to 2; 0: the wall is the whole body. Beside a bonded side
///                      the other part has as small cells, which count too
[[nodiscard]] CellCount thin_wall_count(double volume, double thickness, double edge_length,
                                        int bonded_sides);

/// Linear tetrahedra of `surface`. The mesh keeps the surface's patches; nodes are sorted in space.
/// The volume is compared with the surface's, and every cell is checked.
/// @throws InvalidInput   the surface cannot be meshed (the report's text), or the edge
///                        length makes more than 30 million cells: a slip of a unit; or both
///                        ways to even triangles need more than 2 million
/// @throws WorkerDied     TetGen aborted, crashed, hung or ran out of memory; says what to do
/// @throws NumericalFailure  the volume of the cells is not that of the surface
[[nodiscard]] TetMesh tetrahedralize(const Surface& surface, const MesherOptions& options,
                                     const Progress& progress = {});

}  // namespace chladni::mesh
