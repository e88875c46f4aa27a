// The boundary of a mesh as triangles, for pictures and viewers.
#pragma once

#include "mesh/tet_mesh.h"

namespace chladni::io {

/// Triangles whose corners lie on the boundary's faces, where the nodes' fields are interpolated.
struct Skin {
  /// V×N: a field on the mesh's nodes, seen at the vertices (shape functions of the faces).
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights;
  Cells triangles;        ///< T×3, vertices, outward
  Eigen::VectorXi patch;  ///< T, index into TetMesh::patch_names
  Cells outline;          ///< E×2, vertices: where the surface turns by more than 30 degrees

  [[nodiscard]] Eigen::Index vertex_count() const { return weights.rows(); }
};

/// The skin with each face cut into divisions² triangles. Cost: n log n.
/// @throws InvalidInput  divisions is not in [1, 16]
[[nodiscard]] Skin skin(const mesh::TetMesh& mesh, int divisions);

/// The skin with as many divisions as `max_vertices` allow, but no fewer than the order of the mesh
/// and no more than four times that: curved fields on few large faces are drawn smooth.
[[nodiscard]] Skin smooth_skin(const mesh::TetMesh& mesh, Eigen::Index max_vertices);

/// At most `max_vertices` vertices, for drawing only: those in a cube of space that lie on the same
/// patches and face the same way become the one nearest to their mean. The skin itself where it is
/// small enough already. Cost: linear, a few times.
/// @throws InvalidInput  max_vertices < 8
[[nodiscard]] Skin decimated(const Skin& skin, const Points& points, Eigen::Index max_vertices);

/// The skin's vertices: V×3. @param points  of the mesh
[[nodiscard]] Points vertices(const Skin& skin, const Points& points);

/// A field of 3·nodes rows at the skin's vertices: V×3.
[[nodiscard]] Points field_at(const Skin& skin, const Eigen::Ref<const Eigen::VectorXd>& field);

}  // namespace chladni::io
