// The boundary of a mesh as triangles, for pictures and viewers.
#pragma once

#include "mesh/tet_mesh.h"

namespace chladni::io {

/// Triangles with corners on the boundary's faces, where fields are interpolated from the nodes.
struct Skin {
  /// V×N: interpolates a field from the mesh's nodes to the vertices (the faces' shape functions).
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights;
  Cells triangles;        ///< T×3, vertices, outward
  Eigen::VectorXi patch;  ///< T, index into TetMesh::patch_names
  Cells outline;          ///< E×2, vertices: edges with an angle of more than 30 degrees

  [[nodiscard]] Eigen::Index vertex_count() const { return weights.rows(); }
};

/// The skin with each face divided into divisions² triangles. Cost: n log n.
/// @throws InvalidInput  divisions is not in [1, 16]
[[nodiscard]] Skin skin(const mesh::TetMesh& mesh, int divisions);

/// The skin with as many divisions as `max_vertices` allow, but at least the order of the mesh and
/// at most four times the order. So curved fields on few large faces are drawn smoothly.
[[nodiscard]] Skin smooth_skin(const mesh::TetMesh& mesh, Eigen::Index max_vertices);

/// A skin with at most `max_vertices` vertices, for drawing only. Vertices in a cube of space that
/// lie on the same patches and face the same way are merged into the vertex nearest to their mean.
/// A skin that is small enough stays as it is. Cost: linear, a few times.
/// @throws InvalidInput  max_vertices < 8
[[nodiscard]] Skin decimated(const Skin& skin, const Points& points, Eigen::Index max_vertices);

/// The skin's vertices: V×3. @param points  of the mesh
[[nodiscard]] Points vertices(const Skin& skin, const Points& points);

/// A field of 3·nodes rows at the skin's vertices: V×3.
[[nodiscard]] Points field_at(const Skin& skin, const Eigen::Ref<const Eigen::VectorXd>& field);

}  // namespace chladni::io
