// Improves flat cells by moving their nodes.
#pragma once

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Moves the nodes of linear cells that have a dihedral angle below `degrees` or above
/// 180 − `degrees`. A pattern search moves each node to the place where the worst angle of the
/// cells around it is best. Nodes on a plane of the boundary stay in the plane; nodes on a straight
/// edge stay on the edge. All other boundary nodes and the nodes between regions do not move, so
/// the body and its patches stay the same. No cell gets worse than the worst cell around the node
/// was. Cost: linear, times the flat cells.
void relax(TetMesh& mesh, double degrees);

}  // namespace chladni::mesh
