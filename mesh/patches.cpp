// Names for the parts of a boundary that came without any.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "mesh/disjoint_sets.h"
#include "mesh/numbering.h"
#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {
namespace {

// Twice the area times the unit normal, per face (corners).
Points area_vectors(const TetMesh& mesh) {
  Points vectors(mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d a = mesh.points.row(mesh.faces(f, 0));
    const Eigen::Vector3d b = mesh.points.row(mesh.faces(f, 1));
    const Eigen::Vector3d c = mesh.points.row(mesh.faces(f, 2));
    vectors.row(f) = (b - a).cross(c - a);
  }
  return vectors;
}

// Faces joined across edges less sharp than `angle_degrees`; one smooth piece each.
DisjointSets smooth_pieces(const TetMesh& mesh, const Points& vectors, double angle_degrees) {
  std::vector<Key> keys;
  for (const auto face : mesh.faces.rowwise()) {
    for (const auto& [a, b] : kTriangleEdges) keys.push_back(edge_key(face(a), face(b)));
  }
  const Numbering edges = shared_numbers(keys, static_cast<std::int32_t>(mesh.points.rows()));
  const double least_cosine = std::cos(angle_degrees * std::numbers::pi / 180.0);
  DisjointSets pieces(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto edge = static_cast<std::size_t>(edges.number[i]);
    if (edges.uses[edge] != 2) continue;  // where more than two meet no two belong together
    const auto f = static_cast<Eigen::Index>(i / 3);
    const auto g = static_cast<Eigen::Index>(edges.first[edge] / 3);
    const double cosine =
        vectors.row(f).dot(vectors.row(g)) / (vectors.row(f).norm() * vectors.row(g).norm());
    if (cosine > least_cosine) pieces.join(i / 3, static_cast<std::size_t>(g));
  }
  return pieces;
}

struct Piece {
  Eigen::AlignedBox3d box;
  double area = 0.0;  // [m^2]
  std::string name;
};

// "top" for a flat piece at the highest z, and so on; empty for one that is neither.
std::string name_of_extreme(const Eigen::AlignedBox3d& piece, const Eigen::AlignedBox3d& body) {
  constexpr std::array<const char*, 6> kNames{"x_min", "x_max", "y_min", "y_max", "bottom", "top"};
  const double tolerance = 1e-6 * body.diagonal().norm();
  for (const Eigen::Index axis : {2, 0, 1}) {
    if (piece.max()(axis) - piece.min()(axis) > tolerance) continue;
    if (std::abs(piece.max()(axis) - body.max()(axis)) < tolerance) {
      return kNames[static_cast<std::size_t>(2 * axis + 1)];
    }
    if (std::abs(piece.min()(axis) - body.min()(axis)) < tolerance) {
      return kNames[static_cast<std::size_t>(2 * axis)];
    }
  }
  return {};
}

std::vector<Piece> named(std::vector<Piece> pieces) {
  Eigen::AlignedBox3d body;
  for (const Piece& piece : pieces) body.extend(piece.box);
  std::vector<std::size_t> nameless;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    pieces[i].name = name_of_extreme(pieces[i].box, body);
    if (pieces[i].name.empty()) nameless.push_back(i);
  }
  std::stable_sort(nameless.begin(), nameless.end(),
                   [&](std::size_t a, std::size_t b) { return pieces[a].area > pieces[b].area; });
  for (std::size_t i = 0; i < nameless.size(); ++i) {
    pieces[nameless[i]].name = "side_" + std::to_string(i + 1);
  }
  return pieces;
}

}  // namespace

void name_patches(TetMesh& mesh, double angle_degrees) {
  require(angle_degrees > 0.0 && angle_degrees < 180.0, "name_patches: angle is " +
                                                            std::to_string(angle_degrees) +
                                                            " degrees, expected between 0 and 180");
  const Points vectors = area_vectors(mesh);
  DisjointSets sets = smooth_pieces(mesh, vectors, angle_degrees);
  std::vector<Piece> pieces;
  const std::vector<std::int32_t> piece_of = sets.numbers();
  for (std::size_t f = 0; f < piece_of.size(); ++f) {
    const auto p = static_cast<std::size_t>(piece_of[f]);
    if (p == pieces.size()) pieces.emplace_back();
    const auto row = static_cast<Eigen::Index>(f);
    pieces[p].area += vectors.row(row).norm() / 2.0;
    for (Eigen::Index a = 0; a < mesh.faces.cols(); ++a) {
      pieces[p].box.extend(mesh.points.row(mesh.faces(row, a)).transpose());
    }
  }
  pieces = named(std::move(pieces));
  mesh.patch_names.clear();
  for (const char* first : {"top", "bottom", "x_min", "x_max", "y_min", "y_max"}) {
    if (std::any_of(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.name == first; }))
      mesh.patch_names.emplace_back(first);
  }
  for (std::size_t side = 1;; ++side) {
    const std::string name = "side_" + std::to_string(side);
    if (std::none_of(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.name == name; }))
      break;
    mesh.patch_names.push_back(name);
  }
  mesh.face_patch.resize(mesh.faces.rows());
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const std::string& name =
        pieces[static_cast<std::size_t>(piece_of[static_cast<std::size_t>(f)])].name;
    mesh.face_patch(f) =
        static_cast<int>(std::find(mesh.patch_names.begin(), mesh.patch_names.end(), name) -
                         mesh.patch_names.begin());
  }
}

}  // namespace chladni::mesh
