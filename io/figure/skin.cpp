#include "io/figure/skin.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <vector>

#include "base/error.h"
#include "mesh/numbering.h"
#include "mesh/site.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

using RowWeights = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// The points of a triangle with n divisions per side. Point (i, j), i + j <= n, lies i/n of the way
// to corner 1 and j/n of the way to corner 2.
struct Lattice {
  int n;

  [[nodiscard]] int inner_count() const { return (n - 1) * (n - 2) / 2; }
  [[nodiscard]] int inner(int i, int j) const {  // rows of equal j, from 1
    return (j - 1) * (n - 1) - (j - 1) * j / 2 + i - 1;
  }
  // The shape functions of a face of `order` at point (i, j).
  [[nodiscard]] Eigen::VectorXd shape(int order, int i, int j) const {
    const double a = static_cast<double>(i) / n, b = static_cast<double>(j) / n;
    return mesh::triangle_shape(order, {1.0 - a - b, a, b});
  }
};

// Numbers the lattice points of all faces. Faces share the points on edges and corners.
class LatticeVertices {
 public:
  LatticeVertices(const mesh::TetMesh& mesh, Lattice lattice) : mesh_(mesh), lattice_(lattice) {
    std::vector<mesh::Key> keys;
    std::vector<std::int32_t> corner(static_cast<std::size_t>(mesh.node_count()), -1);
    for (const auto face : mesh.faces.rowwise()) {
      for (const auto& [a, b] : mesh::kTriangleEdges) {
        keys.push_back(mesh::edge_key(face(a), face(b)));
        std::int32_t& number = corner[static_cast<std::size_t>(face(a))];
        if (number < 0) number = corner_count_++;
      }
    }
    corner_ = std::move(corner);
    edges_ = mesh::shared_numbers(keys, static_cast<std::int32_t>(mesh.node_count()));
  }

  [[nodiscard]] Eigen::Index count() const {
    return corner_count_ + static_cast<Eigen::Index>(edges_.first.size()) * (lattice_.n - 1) +
           mesh_.faces.rows() * lattice_.inner_count();
  }

  [[nodiscard]] std::int32_t vertex(Eigen::Index face, int i, int j) const {
    const int n = lattice_.n;
    if (i == 0 && j == 0) return corner(face, 0);
    if (i == n) return corner(face, 1);
    if (j == n) return corner(face, 2);
    if (j == 0) return on_edge(face, 0, i);
    if (i + j == n) return on_edge(face, 1, j);
    if (i == 0) return on_edge(face, 2, n - j);
    const auto first = corner_count_ + static_cast<Eigen::Index>(edges_.first.size()) * (n - 1);
    return static_cast<std::int32_t>(first + face * lattice_.inner_count() + lattice_.inner(i, j));
  }

 private:
  [[nodiscard]] std::int32_t corner(Eigen::Index face, Eigen::Index which) const {
    return corner_[static_cast<std::size_t>(mesh_.faces(face, which))];
  }
  // The number of the point `step`/n of the way along an edge. Numbers on the edge start at its
  // lower node.
  [[nodiscard]] std::int32_t on_edge(Eigen::Index face, Eigen::Index edge, int step) const {
    const auto& [a, b] = mesh::kTriangleEdges[static_cast<std::size_t>(edge)];
    const int place = mesh_.faces(face, a) < mesh_.faces(face, b) ? step : lattice_.n - step;
    const std::int32_t number = edges_.number[static_cast<std::size_t>(3 * face + edge)];
    return corner_count_ + number * (lattice_.n - 1) + place - 1;
  }

  const mesh::TetMesh& mesh_;
  Lattice lattice_;
  std::vector<std::int32_t> corner_;
  std::int32_t corner_count_ = 0;
  mesh::Numbering edges_;
};

RowWeights weights_of(const mesh::TetMesh& mesh, const LatticeVertices& numbers, Lattice lattice) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<bool> done(static_cast<std::size_t>(numbers.count()), false);
  for (int j = 0; j <= lattice.n; ++j) {
    for (int i = 0; i + j <= lattice.n; ++i) {
      const Eigen::VectorXd shape = lattice.shape(mesh.order(), i, j);
      for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const std::int32_t v = numbers.vertex(f, i, j);
        if (done[static_cast<std::size_t>(v)]) continue;
        done[static_cast<std::size_t>(v)] = true;
        for (Eigen::Index a = 0; a < shape.size(); ++a) {
          if (std::abs(shape(a)) > 1e-12) entries.emplace_back(v, mesh.faces(f, a), shape(a));
        }
      }
    }
  }
  RowWeights weights(numbers.count(), mesh.node_count());
  weights.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

Points unit_normals(const Cells& triangles, const Points& points) {
  Points normals(triangles.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = points.row(triangles(t, 0));
    const Eigen::RowVector3d ab = points.row(triangles(t, 1)) - a;
    const Eigen::RowVector3d ac = points.row(triangles(t, 2)) - a;
    normals.row(t) = ab.cross(ac).stableNormalized();
  }
  return normals;
}

// Edges between triangles whose normals differ by more than 30 degrees, and edges of one triangle
// only.
Cells sharp_edges(const Cells& triangles, const Points& points) {
  const double flat = std::cos(std::numbers::pi / 6.0);
  const Points normals = unit_normals(triangles, points);
  using Use = std::tuple<std::int32_t, std::int32_t, Eigen::Index>;
  std::vector<Use> uses;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      const auto [low, high] = std::minmax(triangles(t, a), triangles(t, (a + 1) % 3));
      uses.emplace_back(low, high, t);
    }
  }
  std::sort(uses.begin(), uses.end());
  std::vector<std::int32_t> edges;
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    const auto [low, high, first] = uses[i];
    double alignment = -1.0;  // of an edge that two triangles share
    for (end = i + 1; end < uses.size(); ++end) {
      const auto [a, b, t] = uses[end];
      if (a != low || b != high) break;
      if (end == i + 1) alignment = normals.row(first).dot(normals.row(t));
    }
    if (end == i + 2 && alignment >= flat) continue;
    edges.insert(edges.end(), {low, high});
  }
  return Eigen::Map<Cells>(edges.data(), static_cast<Eigen::Index>(edges.size() / 2), 2);
}

// Row k of the result is row `rows[k]` of `weights`.
RowWeights chosen(const RowWeights& weights, const std::vector<int>& rows) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (RowWeights::InnerIterator entry(weights, rows[k]); entry; ++entry) {
      entries.emplace_back(static_cast<int>(k), static_cast<int>(entry.col()), entry.value());
    }
  }
  RowWeights result(static_cast<Eigen::Index>(rows.size()), weights.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

// The values of `of_vertex` for the vertices that triangles use, in their order. Renumbers
// triangles and lines.
std::vector<int> used(const Eigen::VectorXi& of_vertex, Cells& triangles, Cells& lines) {
  Eigen::VectorXi fresh = Eigen::VectorXi::Constant(of_vertex.size(), -1);
  for (const auto triangle : triangles.rowwise()) {
    for (const std::int32_t v : triangle) fresh(v) = 0;
  }
  std::vector<int> rows;
  for (Eigen::Index v = 0; v < fresh.size(); ++v) {
    if (fresh(v) < 0) continue;
    fresh(v) = static_cast<int>(rows.size());
    rows.push_back(of_vertex(v));
  }
  const auto renumbered = [&](std::int32_t v) { return fresh(v); };
  triangles = triangles.unaryExpr(renumbered).eval();
  lines = lines.unaryExpr(renumbered).eval();
  return rows;
}

// For each vertex, which of the six axis directions it faces, and its patches (one bit each, 64
// bits). On an edge between two patches the direction would be random, so it is 0 there.
struct Sides {
  std::vector<int> direction;
  std::vector<std::uint64_t> patches;
};

Sides sides(const Skin& skin, const Points& at) {
  Points normal = Points::Zero(at.rows(), 3);
  Sides sides{std::vector<int>(static_cast<std::size_t>(at.rows())),
              std::vector<std::uint64_t>(static_cast<std::size_t>(at.rows()))};
  const Points of_triangle = unit_normals(skin.triangles, at);
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    for (const std::int32_t v : skin.triangles.row(t)) {
      normal.row(v) += of_triangle.row(t);
      sides.patches[static_cast<std::size_t>(v)] |= std::uint64_t{1} << (skin.patch(t) % 64);
    }
  }
  for (Eigen::Index v = 0; v < at.rows(); ++v) {
    Eigen::Index axis = 0;
    normal.row(v).cwiseAbs().maxCoeff(&axis);
    const auto i = static_cast<std::size_t>(v);
    if (std::popcount(sides.patches[i]) > 1) continue;
    sides.direction[i] = static_cast<int>(2 * axis + (normal(v, axis) < 0.0 ? 1 : 0));
  }
  return sides;
}

// The cluster of each vertex when space is divided into cubes of `size`.
struct Clusters {
  Eigen::VectorXi of_vertex;
  int count = 0;
};

Clusters clusters(const Points& at, const Sides& sides, double size) {
  const Eigen::RowVector3d low = at.colwise().minCoeff();
  std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t, int, std::uint64_t>, int> numbers;
  Clusters result{Eigen::VectorXi(at.rows()), 0};
  for (Eigen::Index v = 0; v < at.rows(); ++v) {
    const auto cube = ((at.row(v) - low) / size).array().floor().cast<std::int64_t>().eval();
    const auto i = static_cast<std::size_t>(v);
    const auto [entry, is_new] = numbers.try_emplace(
        {cube(0), cube(1), cube(2), sides.direction[i], sides.patches[i]}, result.count);
    if (is_new) ++result.count;
    result.of_vertex(v) = entry->second;
  }
  return result;
}

// One vertex per cluster: the vertex nearest to the mean of the cluster.
Eigen::VectorXi representatives(const Clusters& clusters, const Points& at) {
  Points mean = Points::Zero(clusters.count, 3);
  Eigen::VectorXd size = Eigen::VectorXd::Zero(clusters.count);
  for (Eigen::Index v = 0; v < at.rows(); ++v) {
    mean.row(clusters.of_vertex(v)) += at.row(v);
    size(clusters.of_vertex(v)) += 1.0;
  }
  mean.array().colwise() /= size.array();
  Eigen::VectorXi nearest = Eigen::VectorXi::Constant(clusters.count, -1);
  Eigen::VectorXd distance(clusters.count);
  for (Eigen::Index v = 0; v < at.rows(); ++v) {
    const int c = clusters.of_vertex(v);
    const double d = (at.row(v) - mean.row(c)).squaredNorm();
    if (nearest(c) >= 0 && d >= distance(c)) continue;
    nearest(c) = static_cast<int>(v);
    distance(c) = d;
  }
  return nearest;
}

// Lines between two clusters, each once, if triangles still use both clusters.
Cells merged_lines(const Cells& lines, const Clusters& clusters, const Cells& triangles) {
  std::vector<bool> stands(static_cast<std::size_t>(clusters.count), false);
  for (const auto triangle : triangles.rowwise()) {
    for (const std::int32_t c : triangle) stands[static_cast<std::size_t>(c)] = true;
  }
  std::set<std::pair<std::int32_t, std::int32_t>> pairs;
  for (const auto line : lines.rowwise()) {
    const auto [a, b] = std::minmax(clusters.of_vertex(line(0)), clusters.of_vertex(line(1)));
    const bool both = stands[static_cast<std::size_t>(a)] && stands[static_cast<std::size_t>(b)];
    if (a != b && both) pairs.emplace(a, b);
  }
  Cells result(static_cast<Eigen::Index>(pairs.size()), 2);
  Eigen::Index row = 0;
  for (const auto& [a, b] : pairs) result.row(row++) << a, b;
  return result;
}

Skin merged(const Skin& skin, const Clusters& clusters, const Eigen::VectorXi& representative) {
  Skin result;
  result.triangles.resize(skin.triangles.rows(), 3);
  result.patch.resize(skin.patch.size());
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    const auto corner = [&](Eigen::Index a) { return clusters.of_vertex(skin.triangles(t, a)); };
    const int a = corner(0), b = corner(1), c = corner(2);
    if (a == b || b == c || c == a) continue;
    result.triangles.row(kept) << a, b, c;
    result.patch(kept++) = skin.patch(t);
  }
  result.triangles.conservativeResize(kept, 3);
  result.patch.conservativeResize(kept);
  result.outline = merged_lines(skin.outline, clusters, result.triangles);
  result.weights = chosen(skin.weights, used(representative, result.triangles, result.outline));
  return result;
}

}  // namespace

Points vertices(const Skin& skin, const Points& points) { return skin.weights * points; }

Points field_at(const Skin& skin, const Eigen::Ref<const Eigen::VectorXd>& field) {
  return skin.weights * Eigen::Map<const Points>(field.data(), field.size() / 3, 3);
}

Skin skin(const mesh::TetMesh& mesh, int divisions) {
  require(1 <= divisions && divisions <= 16,
          "a skin of " + fmt::to_string(divisions) + " divisions per face, expected 1 to 16");
  const Lattice lattice{divisions};
  const LatticeVertices numbers(mesh, lattice);
  Skin result;
  result.weights = weights_of(mesh, numbers, lattice);
  result.triangles.resize(mesh.faces.rows() * divisions * divisions, 3);
  result.patch.resize(result.triangles.rows());
  Eigen::Index t = 0;
  const auto add = [&](Eigen::Index f, std::int32_t a, std::int32_t b, std::int32_t c) {
    result.triangles.row(t) << a, b, c;
    result.patch(t++) = mesh.face_patch(f);
  };
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto at = [&](int i, int j) { return numbers.vertex(f, i, j); };
    for (int j = 0; j < divisions; ++j) {
      for (int i = 0; i + j < divisions; ++i) {
        add(f, at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < divisions) add(f, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  result.outline = sharp_edges(result.triangles, vertices(result, mesh.points));
  return result;
}

Skin smooth_skin(const mesh::TetMesh& mesh, Eigen::Index max_vertices) {
  const double faces = static_cast<double>(std::max<Eigen::Index>(mesh.faces.rows(), 1));
  // A closed surface of T triangles has about T / 2 vertices.
  const auto most = static_cast<int>(std::sqrt(2.0 * static_cast<double>(max_vertices) / faces));
  return skin(mesh, std::clamp(most, mesh.order(), 4 * mesh.order()));
}

Skin decimated(const Skin& skin, const Points& points, Eigen::Index max_vertices) {
  require(max_vertices >= 8, "a skin of " + fmt::to_string(max_vertices) +
                                 " vertices was asked for, expected 8 or more");
  if (skin.vertex_count() <= max_vertices) return skin;
  const Points at = vertices(skin, points);
  Sides side = sides(skin, at);
  const auto box = mesh::bounding_box(at);
  const double diagonal = (box.row(1) - box.row(0)).norm();
  double size = diagonal / std::sqrt(static_cast<double>(max_vertices));
  Clusters found = clusters(at, side, size);
  while (found.count > max_vertices) {
    size *= 1.15;
    // There are more patches than vertices. Patches may then merge; six directions remain.
    if (size > diagonal) std::fill(side.patches.begin(), side.patches.end(), 0);
    found = clusters(at, side, size);
  }
  return merged(skin, found, representatives(found, at));
}

}  // namespace chladni::io
