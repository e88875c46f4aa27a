// Cubic tetrahedra as quadratic ones, for programs that do not draw cubic cells.
#pragma once

#include <optional>

#include "mesh/tet_mesh.h"

namespace chladni::io {

/// The mesh itself where its order is 1 or 2; where it is 3, quadratic cells on the same corners,
/// whose mid-edge nodes lie where the cubic edge has its middle. The mesh must outlive it.
class QuadraticCells {
 public:
  explicit QuadraticCells(const mesh::TetMesh& mesh);

  [[nodiscard]] const mesh::TetMesh& mesh() const { return other_ ? *other_ : *original_; }
  /// True where mesh() is not the mesh that was given.
  [[nodiscard]] bool is_other() const { return other_.has_value(); }
  /// A field on the nodes of the given mesh (nodes or 3·nodes rows) on those of mesh(): the cubic
  /// polynomial of the edge, evaluated at its middle; exact for cubic fields.
  [[nodiscard]] Eigen::VectorXd field(const Eigen::Ref<const Eigen::VectorXd>& values) const;

 private:
  void number_nodes();
  [[nodiscard]] Eigen::MatrixXd at_nodes(const Eigen::Ref<const Eigen::MatrixXd>& values) const;

  const mesh::TetMesh* original_;
  std::optional<mesh::TetMesh> other_;
  // One row per node of mesh(): a corner (four times the same) or both corners and both inner nodes
  // of its edge.
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor> from_;
};

}  // namespace chladni::io
