// The Laplace operator of a body's surface or of the body itself.
#pragma once

#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// The matrices of ∫ ∇u·∇v = uᵀ K v and ∫ u v = uᵀ M v. The functions u and v are linear on each
/// small triangle (or tetrahedron) and are given by their values at k points. Rims are free: the
/// slope across a rim is zero.
struct Laplacian {
  SparseMatrix stiffness;  ///< K, k×k, lower triangle [1, or m on a body]: rows sum to 0
  SparseMatrix mass;       ///< M, k×k, lower triangle [m², or m³ on a body], consistent
  Points positions;        ///< k×3 [m]
  Eigen::VectorXi piece;   ///< k: the connected piece that each point belongs to, from 0
  SparseMatrix on_nodes;   ///< N×k: gives values at all nodes of the mesh; 0 rows at other nodes
};

/// The cotangent Laplacian (Pinkall and Polthier 1993) of the named patches of the boundary, or of
/// the whole boundary where `patches` is empty. A face of order 2 or 3 is divided into the 4 or 9
/// triangles between its nodes, so curved faces are accurate to second order. Cost: linear.
/// On the whole boundary of a thin plate, top and bottom are far apart. To avoid this, name one
/// patch or use body_laplacian.
/// @throws InvalidInput  a named patch does not exist (lists the existing ones), or a face has no
///                       area
[[nodiscard]] Laplacian surface_laplacian(const TetMesh& mesh,
                                          const std::vector<std::string>& patches = {});

/// The Laplacian of the body itself on the corners of its tetrahedra, free on all sides. Points on
/// both sides of a thin wall are near; points on both sides of a slot are far. Values at mid-edge
/// and face nodes are interpolated from the corners.
/// Cost: linear. @throws InvalidInput  a tetrahedron without volume
[[nodiscard]] Laplacian body_laplacian(const TetMesh& mesh);

}  // namespace chladni::mesh
