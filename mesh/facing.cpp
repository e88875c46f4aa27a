#include "mesh/facing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "mesh/disjoint_sets.h"
#include "mesh/numbering.h"
#include "mesh/site.h"
#include "mesh/surface.h"

namespace chladni::mesh {
namespace {

constexpr double kSmallPart = 0.01;  // of the largest part's area
constexpr double kLevel = 1e-6;      // of the body's diagonal: tolerance on equal heights

// The boundary alone, turned so that `direction` is the z axis.
TetMesh turned(const TetMesh& body, const Eigen::Vector3d& direction) {
  TetMesh shell;
  shell.tets.resize(0, body.tets.cols());
  shell.faces = body.faces;
  Eigen::Matrix3d axes;
  axes.col(2) = direction;
  axes.col(0) = direction.unitOrthogonal();
  axes.col(1) = direction.cross(axes.col(0));
  shell.points = body.points * axes;
  return shell;
}

// For each face: its area projected along z [m²], negative where it is seen from behind, and
// whether it faces z.
struct Look {
  std::vector<double> area;
  std::vector<char> along;
};

Look look_of(const TetMesh& shell) {
  const double least = std::cos(kFacingDegrees * std::numbers::pi / 180.0);
  Look look;
  for (const auto face : shell.faces.rowwise()) {
    const Eigen::Vector3d a = shell.points.row(face(0));
    const Eigen::Vector3d b = shell.points.row(face(1));
    const Eigen::Vector3d c = shell.points.row(face(2));
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    look.area.push_back(0.5 * twice.z());
    look.along.push_back(twice.z() >= least * twice.norm() && twice.z() > 0.0 ? 1 : 0);
  }
  return look;
}

// Whether nothing of the body lies above the middle of the face.
bool is_seen(const SiteFinder& finder, const TetMesh& shell, Eigen::Index face, double slack) {
  Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) middle += shell.points.row(shell.faces(face, k)) / 3.0;
  const auto highest = finder.from_above(middle.x(), middle.y());
  return highest && (highest->face == face || highest->position.z() <= middle.z() + slack);
}

// For each face, the first face of its part. Parts are joined across edges of two chosen faces.
std::vector<std::size_t> parts_of(const TetMesh& shell, const std::vector<char>& chosen) {
  std::vector<Key> keys;
  std::vector<std::size_t> owner;
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    if (chosen[f] == 0) continue;
    const auto face = shell.faces.row(static_cast<Eigen::Index>(f));
    for (const auto& [a, b] : kTriangleEdges) {
      keys.push_back(edge_key(face(a), face(b)));
      owner.push_back(f);
    }
  }
  const Numbering edges = shared_numbers(keys, static_cast<std::int32_t>(shell.points.rows()));
  DisjointSets sets(chosen.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto first = edges.first[static_cast<std::size_t>(edges.number[i])];
    sets.join(owner[i], owner[static_cast<std::size_t>(first)]);
  }
  std::vector<std::size_t> part(chosen.size());
  for (std::size_t f = 0; f < part.size(); ++f) part[f] = sets.root(f);
  return part;
}

// Leaves out small parts and counts the others.
void keep_large_parts(const TetMesh& shell, const Look& look, Facing& found) {
  const auto part = parts_of(shell, found.face);
  std::vector<double> area(part.size(), 0.0);
  for (std::size_t f = 0; f < part.size(); ++f) {
    if (found.face[f] != 0) area[part[f]] += look.area[f];
  }
  const double least = kSmallPart * *std::max_element(area.begin(), area.end());
  for (std::size_t f = 0; f < part.size(); ++f) {
    if (found.face[f] == 0) continue;
    const bool stays = area[part[f]] >= least;
    if (part[f] == f) ++(stays ? found.parts : found.small_parts);
    if (stays) found.area += look.area[f];
    found.face[f] = stays ? 1 : 0;
  }
}

}  // namespace

Facing facing(const TetMesh& body, const Eigen::Vector3d& direction) {
  require(std::abs(direction.norm() - 1.0) < 1e-9, "facing: the direction is no unit vector");
  const TetMesh shell = turned(body, direction);
  const SiteFinder finder(shell);
  const Look look = look_of(shell);
  const auto box = bounding_box(shell.points);
  const double slack = kLevel * (box.row(1) - box.row(0)).norm();
  Facing found;
  found.face.assign(look.area.size(), 0);
  for (std::size_t f = 0; f < look.area.size(); ++f) {
    if (look.area[f] <= 0.0) continue;
    if (!is_seen(finder, shell, static_cast<Eigen::Index>(f), slack)) continue;
    found.silhouette += look.area[f];
    found.face[f] = look.along[f];
  }
  keep_large_parts(shell, look, found);
  return found;
}

}  // namespace chladni::mesh
