// The Laplace operator of a body's surface, or of the body: what says which places are neighbours.
#pragma once

#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// ∫ ∇u·∇v = uᵀ K v and ∫ u v = uᵀ M v of functions that are linear on each of many small
/// triangles (or tetrahedra), by their values at k points. Rims are free: no slope across them.
struct Laplacian {
  SparseMatrix stiffness;  ///< K, k×k, lower triangle [1, or m on a body]: rows sum to 0
  SparseMatrix mass;       ///< M, k×k, lower triangle [m², or m³ on a body], consistent
  Points positions;        ///< k×3 [m]
  Eigen::VectorXi piece;   ///< k: which connected piece each point belongs to, from 0
  SparseMatrix on_nodes;   ///< N×k: values at all nodes of the mesh; 0 rows where nothing is known
};

/// The cotangent Laplacian (Pinkall and Polthier 1993) of the named patches of the boundary, of all
/// of it where `patches` is empty. A face of order 2 or 3 counts as the 4 or 9 triangles between
/// its nodes, so curved faces are met to second order. Cost: linear.
/// On the whole boundary of a thin plate top and bottom are far apart; name one patch, or take
/// body_laplacian, where that is not meant.
/// @throws InvalidInput  there is no patch of a name (lists those there are), or a face without
/// area
[[nodiscard]] Laplacian surface_laplacian(const TetMesh& mesh,
                                          const std::vector<std::string>& patches = {});

/// The Laplacian of the body itself on its tetrahedra's corners, free on all sides: through a thin
/// wall is near, around a slot is far. Mid-edge and face nodes lie between their corners.
/// Cost: linear. @throws InvalidInput  a tetrahedron without volume
[[nodiscard]] Laplacian body_laplacian(const TetMesh& mesh);

}  // namespace chladni::mesh
