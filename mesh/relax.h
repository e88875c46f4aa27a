// Flat cells made better by moving their inner nodes. Of this room only.
#pragma once

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Moves nodes inside of one region (none of the boundary, none between regions) of linear cells
/// with a dihedral angle that is smaller than `degrees` or within `degrees` of 180, each to where
/// the worst angle of the cells around it is best (a pattern search). No cell gets worse than the
/// worst around the node was. Cost: linear, times the few cells that are flat.
void relax(TetMesh& mesh, double degrees);

}  // namespace chladni::mesh
