// The parts of a mesh and the joints between them.
#pragma once

#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// A division of the cells into parts.
struct Parts {
  std::vector<std::int32_t> of_cell;  ///< T: part
  int count = 0;
};

/// The parts whose cells are connected by common faces. Cost: linear, as find_boundary.
[[nodiscard]] Parts parts_by_faces(const TetMesh& mesh);

/// A place where two parts meet in an edge or a node only.
struct Joint {
  int first = 0, second = 0;       ///< parts
  std::vector<std::int32_t> node;  ///< the shared nodes, ascending
};

/// The parts and joints of a mechanism. Its parts can move against each other without energy,
/// because they share only one node (a ball joint) or the nodes of a line (a hinge). Parts that
/// share three nodes not on a line count as one part.
struct Mechanism {
  Parts parts = {};                ///< each moves as a rigid whole
  std::vector<Joint> joints = {};  ///< between them
  int free_motions = 0;            ///< beside the six of the whole body; 0: there is no mechanism
};

/// Finds a mechanism. Parts are rigid bodies, joined at shared nodes. The free motions are the null
/// space of the joint conditions less the six motions of the whole body. Cost: linear in the mesh,
/// cubic in the parts (at most 60; more than 60 parts that meet only in edges and nodes count as a
/// mechanism).
[[nodiscard]] Mechanism mechanism(const TetMesh& mesh);

}  // namespace chladni::mesh
