// Renumbers a mesh so that neighbours in space become neighbours in memory.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {
namespace {

double mean_edge_length(const TetMesh& mesh) {
  double sum = 0.0;
  for (const auto tet : mesh.tets.rowwise()) {
    for (const auto& [a, b] : kTetEdges) {
      sum += (mesh.points.row(tet(a)) - mesh.points.row(tet(b))).norm();
    }
  }
  return sum / static_cast<double>(6 * std::max<Eigen::Index>(mesh.tets.rows(), 1));
}

// The order of points: by slab along the longest direction, then by row in the slab along the
// middle direction, then along the shortest direction. Points at equal places keep their old order.
std::vector<std::int32_t> order_of(const Points& points, double step) {
  const Eigen::RowVector3d low = points.colwise().minCoeff();
  const Eigen::RowVector3d extent = points.colwise().maxCoeff() - low;
  std::array<Eigen::Index, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return extent(a) > extent(b); });
  struct Place {
    double slab, row, height, along;
  };
  std::vector<Place> places(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    const Eigen::RowVector3d at = (points.row(p) - low) / step;
    places[static_cast<std::size_t>(p)] = {std::floor(at(axes[0]) + 0.5),
                                           std::floor(at(axes[1]) + 0.5), at(axes[2]), at(axes[0])};
  }
  std::vector<std::int32_t> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) {
    const Place& a = places[static_cast<std::size_t>(i)];
    const Place& b = places[static_cast<std::size_t>(j)];
    return std::tie(a.slab, a.row, a.height, a.along, i) <
           std::tie(b.slab, b.row, b.height, b.along, j);
  });
  return order;
}

// The order of rows by their smallest entry. Rows with equal entries keep their old order.
std::vector<Eigen::Index> order_of_cells(const Cells& cells) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(cells.rows()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  if (cells.rows() == 0) return order;
  const Eigen::VectorXi lowest = cells.rowwise().minCoeff();
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return lowest(a) < lowest(b); });
  return order;
}

void reorder(Cells& cells, Eigen::VectorXi& label) {
  const auto order = order_of_cells(cells);
  const Cells old_cells = cells;
  const Eigen::VectorXi old_label = label;
  for (std::size_t i = 0; i < order.size(); ++i) {
    cells.row(static_cast<Eigen::Index>(i)) = old_cells.row(order[i]);
    label(static_cast<Eigen::Index>(i)) = old_label(order[i]);
  }
}

}  // namespace

void sort_in_space(TetMesh& mesh) {
  if (mesh.points.rows() == 0) return;
  const double edge = mean_edge_length(mesh) / mesh.order();
  const auto order = order_of(mesh.points, edge > 0.0 ? edge : 1.0);
  const Points old_points = mesh.points;
  std::vector<std::int32_t> fresh(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    fresh[static_cast<std::size_t>(order[i])] = static_cast<std::int32_t>(i);
    mesh.points.row(static_cast<Eigen::Index>(i)) = old_points.row(order[i]);
  }
  const auto renumbered = [&](std::int32_t p) { return fresh[static_cast<std::size_t>(p)]; };
  mesh.tets = mesh.tets.unaryExpr(renumbered).eval();
  mesh.faces = mesh.faces.unaryExpr(renumbered).eval();
  reorder(mesh.tets, mesh.region);
  reorder(mesh.faces, mesh.face_patch);
}

}  // namespace chladni::mesh
