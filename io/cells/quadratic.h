// Converts cubic tetrahedra to quadratic ones, for programs that do not draw cubic cells.
#pragma once

#include <optional>

#include "mesh/tet_mesh.h"

namespace chladni::io {

/// A mesh of order 1 or 2 stays as it is. A mesh of order 3 becomes quadratic cells on the same
/// corners, with mid-edge nodes at the middle of the cubic edges. The mesh must outlive this
/// object.
class QuadraticCells {
 public:
  explicit QuadraticCells(const mesh::TetMesh& mesh);

  [[nodiscard]] const mesh::TetMesh& mesh() const { return other_ ? *other_ : *original_; }
  /// True where mesh() is not the given mesh.
  [[nodiscard]] bool is_other() const { return other_.has_value(); }
  /// Converts a field on the nodes of the given mesh (nodes or 3·nodes rows) to the nodes of
  /// mesh(). The cubic polynomial of each edge is evaluated at its middle; this is exact for cubic
  /// fields.
  [[nodiscard]] Eigen::VectorXd field(const Eigen::Ref<const Eigen::VectorXd>& values) const;

 private:
  void number_nodes();
  [[nodiscard]] Eigen::MatrixXd at_nodes(const Eigen::Ref<const Eigen::MatrixXd>& values) const;

  const mesh::TetMesh* original_;
  std::optional<mesh::TetMesh> other_;
  // One row per node of mesh(): a corner (the same number four times), or both corners and both
  // inner nodes of the node's edge.
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor> from_;
};

}  // namespace chladni::io
