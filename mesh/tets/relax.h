// Flat cells made better by moving their nodes.
#pragma once

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Moves nodes of linear cells with a dihedral angle that is smaller than `degrees` or within
/// `degrees` of 180, each to where the worst angle of the cells around it is best (a pattern
/// search). Nodes on a plane of the boundary stay in it, those on a straight edge stay on it, all
/// others on the boundary and those between regions stay where they are: body and patches are the
/// same. No cell gets worse than the worst around the node was. Cost: linear, times the flat cells.
void relax(TetMesh& mesh, double degrees);

}  // namespace chladni::mesh
