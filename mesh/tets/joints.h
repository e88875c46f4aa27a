// What holds the parts of a mesh together.
#pragma once

#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Cells that hang together by faces and the nodes that they share with other parts.
struct Parts {
  std::vector<std::int32_t> of_cell;  ///< T: part
  int count = 0;
};

/// Parts whose cells hang together by common faces. Cost: linear, as find_boundary.
[[nodiscard]] Parts parts_by_faces(const TetMesh& mesh);

/// One place at which parts meet in an edge or a node only.
struct Joint {
  int first = 0, second = 0;       ///< parts
  std::vector<std::int32_t> node;  ///< that both have, ascending
};

/// The parts and joints of a mechanism: parts that move against each other at no cost, because
/// they share one node (a ball joint) or the nodes of a line (a hinge) and nothing else holds them.
/// Parts that share three nodes off a line are one.
struct Mechanism {
  Parts parts;                ///< that move as a whole
  std::vector<Joint> joints;  ///< between them
  int free_motions = 0;       ///< beside the six of the body as a whole; 0: it is no mechanism
};

/// Parts as rigid bodies, joined where they share nodes: the null space of the joints less the six
/// motions of the whole. Cost: linear in the mesh, cubic in the parts (at most 60; more that hang
/// together by edges and nodes count as a mechanism).
[[nodiscard]] Mechanism mechanism(const TetMesh& mesh);

}  // namespace chladni::mesh
