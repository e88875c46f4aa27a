#include "mesh/patches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "mesh/disjoint_sets.h"
#include "mesh/numbering.h"
#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

// Triangles of any order, outward.
struct Boundary {
  const Points& points;
  const Cells& faces;
};

// Twice the area times the unit normal, per face (corners).
Points area_vectors(const Boundary& mesh) {
  Points vectors(mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d a = mesh.points.row(mesh.faces(f, 0));
    const Eigen::Vector3d b = mesh.points.row(mesh.faces(f, 1));
    const Eigen::Vector3d c = mesh.points.row(mesh.faces(f, 2));
    vectors.row(f) = (b - a).cross(c - a);
  }
  return vectors;
}

// Joins faces across edges less sharp than `angle_degrees`. Each set is one smooth piece.
DisjointSets smooth_pieces(const Boundary& mesh, const Points& vectors, double angle_degrees) {
  std::vector<Key> keys;
  for (const auto face : mesh.faces.rowwise()) {
    for (const auto& [a, b] : kTriangleEdges) keys.push_back(edge_key(face(a), face(b)));
  }
  const Numbering edges = shared_numbers(keys, static_cast<std::int32_t>(mesh.points.rows()));
  const double least_cosine = std::cos(angle_degrees * std::numbers::pi / 180.0);
  DisjointSets pieces(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto edge = static_cast<std::size_t>(edges.number[i]);
    if (edges.uses[edge] != 2) continue;  // faces are not joined where more than two meet
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
};

// The names, in the order of the patches.
constexpr std::array<const char*, 6> kExtremes{"top", "bottom", "x_min", "x_max", "y_min", "y_max"};

// The index in kExtremes of a flat piece at the highest or lowest z, x or y; -1 for other pieces.
int extreme_of(const Eigen::AlignedBox3d& piece, const Eigen::AlignedBox3d& body) {
  constexpr std::array<int, 6> kLowAndHigh{2, 3, 4, 5, 1, 0};  // x, y, z
  const double tolerance = 1e-6 * body.diagonal().norm();
  for (const Eigen::Index axis : {2, 0, 1}) {
    if (piece.max()(axis) - piece.min()(axis) > tolerance) continue;
    if (std::abs(piece.max()(axis) - body.max()(axis)) < tolerance) {
      return kLowAndHigh[static_cast<std::size_t>(2 * axis + 1)];
    }
    if (std::abs(piece.min()(axis) - body.min()(axis)) < tolerance) {
      return kLowAndHigh[static_cast<std::size_t>(2 * axis)];
    }
  }
  return -1;
}

std::vector<Piece> pieces_of(const Boundary& mesh, const Points& vectors,
                             const std::vector<std::int32_t>& piece_of) {
  std::vector<Piece> pieces;
  for (std::size_t f = 0; f < piece_of.size(); ++f) {
    const auto p = static_cast<std::size_t>(piece_of[f]);
    if (p == pieces.size()) pieces.emplace_back();
    const auto row = static_cast<Eigen::Index>(f);
    pieces[p].area += vectors.row(row).norm() / 2.0;
    for (Eigen::Index a = 0; a < mesh.faces.cols(); ++a) {
      pieces[p].box.extend(mesh.points.row(mesh.faces(row, a)).transpose());
    }
  }
  return pieces;
}

struct Patches {
  std::vector<std::string> names;
  std::vector<int> of_piece;
};

Patches named(const std::vector<Piece>& pieces) {
  Eigen::AlignedBox3d body;
  for (const Piece& piece : pieces) body.extend(piece.box);
  std::vector<int> extreme;
  for (const Piece& piece : pieces) extreme.push_back(extreme_of(piece.box, body));
  Patches patches;
  std::array<int, kExtremes.size()> number{};
  for (std::size_t k = 0; k < kExtremes.size(); ++k) {
    if (std::find(extreme.begin(), extreme.end(), static_cast<int>(k)) == extreme.end()) continue;
    number[k] = static_cast<int>(patches.names.size());
    patches.names.emplace_back(kExtremes[k]);
  }
  std::vector<std::size_t> sides;
  patches.of_piece.resize(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (extreme[i] < 0) {
      sides.push_back(i);
    } else {
      patches.of_piece[i] = number[static_cast<std::size_t>(extreme[i])];
    }
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [&](std::size_t a, std::size_t b) { return pieces[a].area > pieces[b].area; });
  for (std::size_t i = 0; i < sides.size(); ++i) {
    patches.of_piece[sides[i]] = static_cast<int>(patches.names.size());
    patches.names.push_back("side_" + std::to_string(i + 1));
  }
  return patches;
}

// Sets the patch of each face; returns the patch names.
std::vector<std::string> split(const Boundary& mesh, double angle_degrees,
                               Eigen::VectorXi& face_patch) {
  require(angle_degrees > 0.0 && angle_degrees < 180.0, "name_patches: angle is " +
                                                            std::to_string(angle_degrees) +
                                                            " degrees, expected between 0 and 180");
  const Points vectors = area_vectors(mesh);
  DisjointSets sets = smooth_pieces(mesh, vectors, angle_degrees);
  const std::vector<std::int32_t> piece_of = sets.numbers();
  Patches patches = named(pieces_of(mesh, vectors, piece_of));
  face_patch.resize(mesh.faces.rows());
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto piece = static_cast<std::size_t>(piece_of[static_cast<std::size_t>(f)]);
    face_patch(f) = patches.of_piece[piece];
  }
  return std::move(patches.names);
}

}  // namespace

void name_patches(TetMesh& mesh, double angle_degrees) {
  mesh.patch_names = split({mesh.points, mesh.faces}, angle_degrees, mesh.face_patch);
}

void name_patches(Surface& surface, double angle_degrees) {
  surface.patch_names = split({surface.points, surface.triangles}, angle_degrees, surface.patch);
}

std::vector<char> bounding_patches(const Surface& surface) {
  const Material filled = material(surface, shells(surface));
  std::vector<char> bounds(surface.patch_names.size(), 0);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (!filled.outer(static_cast<std::size_t>(t))) continue;
    bounds[static_cast<std::size_t>(surface.patch(t))] = 1;
  }
  return bounds;
}

}  // namespace chladni::mesh
