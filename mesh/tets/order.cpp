// Adds the nodes of orders 2 and 3 on the edges and faces of tetrahedra.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "mesh/numbering.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {
namespace {

void require_order(int order) {
  require(order == 1 || order == 2 || order == 3,
          "element order is " + fmt::to_string(order) + ", expected 1, 2 or 3");
}

// Barycentric coordinates of the corners, then of the inner nodes of each edge.
template <std::size_t edge_count>
Eigen::MatrixXd edge_lattice(int corners, int order, int nodes,
                             const std::array<std::array<int, 2>, edge_count>& edges) {
  Eigen::MatrixXd barycentric = Eigen::MatrixXd::Zero(nodes, corners);
  barycentric.topRows(corners).setIdentity();
  Eigen::Index row = corners;
  for (const auto& [from, to] : edges) {
    for (int k = 1; k < order; ++k, ++row) {
      barycentric(row, from) = static_cast<double>(order - k) / order;
      barycentric(row, to) = static_cast<double>(k) / order;
    }
  }
  return barycentric;
}

// Only the corners of the tetrahedra (of the triangles of a shell), in their old order.
struct CornerNodes {
  std::vector<std::int32_t> old;  // row -> row of mesh.points
  Cells tets, faces;              // T x 4, F x 3, in the new rows
};

CornerNodes corner_nodes(const TetMesh& mesh) {
  const auto n = static_cast<std::int32_t>(mesh.points.rows());
  std::vector<std::int32_t> fresh(static_cast<std::size_t>(n), -1);
  const bool is_shell = mesh.tets.rows() == 0;
  const Cells& cells = is_shell ? mesh.faces : mesh.tets;
  for (Eigen::Index t = 0; t < cells.rows(); ++t) {
    for (Eigen::Index a = 0; a < (is_shell ? 3 : 4); ++a) {
      const std::int32_t p = cells(t, a);
      require(0 <= p && p < n, (is_shell ? "triangle " : "tetrahedron ") + fmt::to_string(t) +
                                   " names point " + fmt::to_string(p) + ", there are " +
                                   fmt::to_string(n));
      fresh[static_cast<std::size_t>(p)] = 0;
    }
  }
  CornerNodes result;
  for (std::int32_t p = 0; p < n; ++p) {
    if (fresh[static_cast<std::size_t>(p)] < 0) continue;
    fresh[static_cast<std::size_t>(p)] = static_cast<std::int32_t>(result.old.size());
    result.old.push_back(p);
  }
  const auto renumbered = [&](std::int32_t p) {
    require(0 <= p && p < n && fresh[static_cast<std::size_t>(p)] >= 0,
            "a boundary face names point " + fmt::to_string(p) +
                ", which is a corner of no tetrahedron");
    return fresh[static_cast<std::size_t>(p)];
  };
  result.tets.resize(mesh.tets.rows(), 4);
  if (mesh.tets.rows() > 0) result.tets = mesh.tets.leftCols(4).unaryExpr(renumbered);
  result.faces.resize(mesh.faces.rows(), 3);
  if (mesh.faces.rows() > 0) result.faces = mesh.faces.leftCols(3).unaryExpr(renumbered);
  return result;
}

Numbering edge_numbers(const TetMesh& corners) {
  std::vector<Key> keys;
  keys.reserve(static_cast<std::size_t>(6 * corners.tets.rows() + 3 * corners.faces.rows()));
  for (const auto tet : corners.tets.rowwise()) {
    for (const auto& [a, b] : kTetEdges) keys.push_back(edge_key(tet(a), tet(b)));
  }
  for (const auto face : corners.faces.rowwise()) {
    for (const auto& [a, b] : kTriangleEdges) keys.push_back(edge_key(face(a), face(b)));
  }
  return shared_numbers(keys, static_cast<std::int32_t>(corners.points.rows()));
}

Numbering face_numbers(const TetMesh& corners) {
  std::vector<Key> keys;
  keys.reserve(static_cast<std::size_t>(4 * corners.tets.rows() + corners.faces.rows()));
  for (const auto tet : corners.tets.rowwise()) {
    for (const auto& [a, b, c] : kTetFaces) keys.push_back(face_key(tet(a), tet(b), tet(c)));
  }
  for (const auto face : corners.faces.rowwise()) {
    keys.push_back(face_key(face(0), face(1), face(2)));
  }
  return shared_numbers(keys, static_cast<std::int32_t>(corners.points.rows()));
}

// Writes the edge nodes into the rows of `cells`. Node k of an edge is counted from the corner with
// the lower number.
template <std::size_t edge_count>
void put_edge_nodes(Cells& cells, int corners, int order, std::int32_t first_node,
                    const std::array<std::array<int, 2>, edge_count>& edges,
                    const std::int32_t* numbers) {
  const int inner = order - 1;
  for (auto cell : cells.rowwise()) {
    Eigen::Index column = corners;
    for (const auto& [a, b] : edges) {
      const std::int32_t base = first_node + *numbers++ * inner;
      for (int k = 0; k < inner; ++k) {
        cell(column++) = base + (cell(a) < cell(b) ? k : inner - 1 - k);
      }
    }
  }
}

// Places the nodes of `cells` by their barycentric coordinates. The place of a shared node is the
// same from each cell up to round-off; the first cell decides.
template <int corners>
void place_nodes(const Cells& cells, const Eigen::MatrixXd& barycentric, Points& points) {
  Eigen::Matrix<double, corners, 3> corner;
  for (Eigen::Index t = cells.rows() - 1; t >= 0; --t) {
    for (int a = 0; a < corners; ++a) corner.row(a) = points.row(cells(t, a));
    for (Eigen::Index a = corners; a < barycentric.rows(); ++a) {
      points.row(cells(t, a)) = barycentric.row(a) * corner;
    }
  }
}

constexpr double kStraight = 1e-9;  // a smaller bend is round-off

// The nodes of tetrahedron `t`.
Points nodes_of_tet(const TetMesh& mesh, Eigen::Index t) {
  Points nodes(mesh.tets.cols(), 3);
  for (Eigen::Index a = 0; a < nodes.rows(); ++a) nodes.row(a) = mesh.points.row(mesh.tets(t, a));
  return nodes;
}

// The bend of one tetrahedron, as largest_bend. `barycentric` is that of its nodes.
double bend_of(const Points& nodes, const Eigen::MatrixXd& barycentric) {
  double longest = 0.0;
  for (const auto& [a, b] : kTetEdges) {
    longest = std::max(longest, (nodes.row(a) - nodes.row(b)).norm());
  }
  const Eigen::MatrixX3d off = nodes - barycentric * nodes.topRows(4);
  return off.rowwise().norm().maxCoeff() / longest;
}

// The monomials of (λ1, λ2, λ3) up to degree `order` at points of a tetrahedron: points x
// monomials.
Eigen::MatrixXd monomials(int order, const Eigen::MatrixXd& barycentric) {
  Eigen::MatrixXd values(barycentric.rows(), tet_nodes(order));
  Eigen::Index m = 0;
  for (int i = 0; i <= order; ++i) {
    for (int j = 0; i + j <= order; ++j) {
      for (int k = 0; i + j + k <= order; ++k, ++m) {
        values.col(m) = barycentric.col(1).array().pow(i) * barycentric.col(2).array().pow(j) *
                        barycentric.col(3).array().pow(k);
      }
    }
  }
  return values;
}

// Moves the nodes of curved cells from the straight edges and flat faces to the places that the
// shape functions of the old nodes give them.
void bend_as(const TetMesh& old, TetMesh& mesh) {
  const Eigen::MatrixXd from = tet_node_barycentric(old.order());
  const Eigen::MatrixXd shapes = monomials(old.order(), tet_node_barycentric(mesh.order())) *
                                 monomials(old.order(), from).inverse();
  for (Eigen::Index t = mesh.tets.rows() - 1; t >= 0; --t) {
    const Points nodes = nodes_of_tet(old, t);
    if (bend_of(nodes, from) < kStraight) continue;
    const Points bent = shapes * nodes;
    for (Eigen::Index a = 4; a < bent.rows(); ++a) mesh.points.row(mesh.tets(t, a)) = bent.row(a);
  }
}

// Adds the nodes of `order` to a mesh of corners only.
void add_nodes(TetMesh& mesh, int order) {
  const Numbering edges = edge_numbers(mesh);
  const Numbering faces = face_numbers(mesh);
  const Eigen::Index tets = mesh.tets.rows();
  for (const std::int32_t first : faces.first) {
    require(tets == 0 || first < 4 * tets, "boundary face " + fmt::to_string(first - 4 * tets) +
                                               " is not a face of any tetrahedron");
  }
  const Eigen::Index corners = mesh.points.rows();
  const auto edge_nodes = static_cast<Eigen::Index>(edges.first.size()) * (order - 1);
  const Eigen::Index face_count = order == 3 ? static_cast<Eigen::Index>(faces.first.size()) : 0;
  const Eigen::Index count = corners + edge_nodes + face_count;
  require(count <= std::numeric_limits<std::int32_t>::max(),
          "mesh: " + fmt::to_string(count) + " nodes, at most 2^31 - 1 can be numbered");
  mesh.points.conservativeResize(count, 3);
  mesh.tets.conservativeResize(tets, tet_nodes(order));
  mesh.faces.conservativeResize(mesh.faces.rows(), face_nodes(order));
  const auto first = static_cast<std::int32_t>(corners);
  put_edge_nodes(mesh.tets, 4, order, first, kTetEdges, edges.number.data());
  put_edge_nodes(mesh.faces, 3, order, first, kTriangleEdges, edges.number.data() + 6 * tets);
  if (order == 3) {
    const auto centre = static_cast<std::int32_t>(corners + edge_nodes);
    for (Eigen::Index i = 0; i < 4 * tets; ++i) {
      mesh.tets(i / 4, 16 + i % 4) = centre + faces.number[static_cast<std::size_t>(i)];
    }
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      mesh.faces(f, 9) = centre + faces.number[static_cast<std::size_t>(4 * tets + f)];
    }
  }
  if (tets == 0) place_nodes<3>(mesh.faces, triangle_node_barycentric(order), mesh.points);
  place_nodes<4>(mesh.tets, tet_node_barycentric(order), mesh.points);
}

}  // namespace

Eigen::MatrixXd tet_node_barycentric(int order) {
  require_order(order);
  Eigen::MatrixXd nodes = edge_lattice(4, order, tet_nodes(order), kTetEdges);
  if (order == 3) {
    for (std::size_t f = 0; f < 4; ++f) {
      for (const int corner : kTetFaces[f]) {
        nodes(16 + static_cast<Eigen::Index>(f), corner) = 1.0 / 3.0;
      }
    }
  }
  return nodes;
}

Eigen::MatrixXd triangle_node_barycentric(int order) {
  require_order(order);
  Eigen::MatrixXd nodes = edge_lattice(3, order, face_nodes(order), kTriangleEdges);
  if (order == 3) nodes.row(9).setConstant(1.0 / 3.0);
  return nodes;
}

Eigen::MatrixXi tet_face_nodes(int order) {
  const Eigen::MatrixXd tet = tet_node_barycentric(order);
  const Eigen::MatrixXd triangle = triangle_node_barycentric(order);
  Eigen::MatrixXi nodes(4, triangle.rows());
  for (Eigen::Index f = 0; f < 4; ++f) {
    for (Eigen::Index a = 0; a < triangle.rows(); ++a) {
      Eigen::RowVector4d at = Eigen::RowVector4d::Zero();
      for (std::size_t c = 0; c < 3; ++c) {
        at(kTetFaces[static_cast<std::size_t>(f)][c]) = triangle(a, static_cast<Eigen::Index>(c));
      }
      Eigen::Index nearest = 0;
      (tet.rowwise() - at).rowwise().squaredNorm().minCoeff(&nearest);
      nodes(f, a) = static_cast<int>(nearest);
    }
  }
  return nodes;
}

TetMesh with_order(const TetMesh& mesh, int order) {
  require_order(order);
  const CornerNodes corners = corner_nodes(mesh);
  TetMesh result;
  result.region = mesh.region;
  result.face_patch = mesh.face_patch;
  result.patch_names = mesh.patch_names;
  result.region_names = mesh.region_names;
  const auto corner_count = static_cast<Eigen::Index>(corners.old.size());
  result.points.resize(corner_count, 3);
  for (Eigen::Index p = 0; p < corner_count; ++p) {
    result.points.row(p) = mesh.points.row(corners.old[static_cast<std::size_t>(p)]);
  }
  result.tets = corners.tets;
  result.faces = corners.faces;
  if (order > 1) add_nodes(result, order);
  if (order > 1 && mesh.order() > 1) bend_as(mesh, result);
  return result;
}

double largest_bend(const TetMesh& mesh) {
  if (mesh.order() == 1) return 0.0;
  const Eigen::MatrixXd barycentric = tet_node_barycentric(mesh.order());
  double largest = 0.0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    largest = std::max(largest, bend_of(nodes_of_tet(mesh, t), barycentric));
  }
  return largest;
}

}  // namespace chladni::mesh
