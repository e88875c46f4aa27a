#include "io/cells/quadratic.h"

#include <algorithm>
#include <array>
#include <vector>

namespace chladni::io {
namespace {

using From = std::array<std::int32_t, 4>;

}  // namespace

QuadraticCells::QuadraticCells(const mesh::TetMesh& mesh) : original_(&mesh) {
  if (mesh.order() < 3) return;
  other_.emplace();
  number_nodes();
  other_->points = at_nodes(mesh.points);
  other_->region = mesh.region;
  other_->face_patch = mesh.face_patch;
  other_->patch_names = mesh.patch_names;
  other_->region_names = mesh.region_names;
}

void QuadraticCells::number_nodes() {
  std::vector<From> from;
  std::vector<std::int32_t> fresh(static_cast<std::size_t>(original_->node_count()), -1);
  // The new node for a corner, or for the edge with the inner node `key`.
  const auto node = [&](std::int32_t key, const From& nodes) {
    std::int32_t& row = fresh[static_cast<std::size_t>(key)];
    if (row < 0) {
      row = static_cast<std::int32_t>(from.size());
      from.push_back(nodes);
    }
    return row;
  };
  const auto renumber = [&](const Cells& cells, Eigen::Index corners, const auto& edges) {
    const auto count = static_cast<Eigen::Index>(edges.size());
    Cells result(cells.rows(), corners + count);
    for (Eigen::Index c = 0; c < cells.rows(); ++c) {
      for (Eigen::Index a = 0; a < corners; ++a) {
        const std::int32_t p = cells(c, a);
        result(c, a) = node(p, {p, p, p, p});
      }
      for (Eigen::Index e = 0; e < count; ++e) {
        const auto& [a, b] = edges[static_cast<std::size_t>(e)];
        const std::int32_t first = cells(c, corners + 2 * e),
                           second = cells(c, corners + 2 * e + 1);
        result(c, corners + e) =
            node(std::min(first, second), {cells(c, a), cells(c, b), first, second});
      }
    }
    return result;
  };
  other_->tets = renumber(original_->tets, 4, mesh::kTetEdges);
  other_->faces = renumber(original_->faces, 3, mesh::kTriangleEdges);
  from_.resize(static_cast<Eigen::Index>(from.size()), 4);
  for (Eigen::Index i = 0; i < from_.rows(); ++i) {
    for (Eigen::Index k = 0; k < 4; ++k) {
      from_(i, k) = from[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    }
  }
}

// Lagrange's cubic on the nodes 0, 1/3, 2/3, 1 at 1/2: (−1, 9, 9, −1) / 16.
Eigen::MatrixXd QuadraticCells::at_nodes(const Eigen::Ref<const Eigen::MatrixXd>& values) const {
  Eigen::MatrixXd result(from_.rows(), values.cols());
  for (Eigen::Index i = 0; i < from_.rows(); ++i) {
    const auto row = [&](Eigen::Index k) { return values.row(from_(i, k)); };
    if (from_(i, 0) == from_(i, 1)) {
      result.row(i) = row(0);
    } else {
      result.row(i) = (9.0 * (row(2) + row(3)) - (row(0) + row(1))) / 16.0;
    }
  }
  return result;
}

Eigen::VectorXd QuadraticCells::field(const Eigen::Ref<const Eigen::VectorXd>& values) const {
  if (!is_other()) return values;
  const Eigen::Index columns = values.size() / original_->node_count();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = at_nodes(
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          values.data(), original_->node_count(), columns));
  return Eigen::Map<Eigen::VectorXd>(rows.data(), rows.size());
}

}  // namespace chladni::io
