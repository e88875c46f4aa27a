#include "mesh/tets/relax.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace chladni::mesh {
namespace {

// A plane of the boundary at a node, with its patch.
struct Plane {
  Eigen::RowVector3d normal;
  int patch = 0;
};
using Planes = std::vector<Plane>;

Planes planes_of(const TetMesh& mesh, const std::vector<int>& faces) {
  constexpr double parallel = 1e-4;  // radians: error of a small triangle in single precision
  Planes planes;
  for (const int f : faces) {
    const Eigen::RowVector3d a = mesh.points.row(mesh.faces(f, 0));
    const Eigen::RowVector3d u = mesh.points.row(mesh.faces(f, 1)) - a;
    const Eigen::RowVector3d v = mesh.points.row(mesh.faces(f, 2)) - a;
    const Plane plane{u.cross(v).normalized(), mesh.face_patch[f]};
    const bool known = std::any_of(planes.begin(), planes.end(), [&](const Plane& p) {
      return p.patch == plane.patch && p.normal.dot(plane.normal) > 0.0 &&
             p.normal.cross(plane.normal).norm() < parallel;
    });
    if (!known) planes.push_back(plane);
  }
  return planes;
}

// Unit vectors along which a node may move without changing the body or its patches: all directions
// inside the body, in-plane directions on one plane, the edge direction where two planes meet.
std::vector<Eigen::RowVector3d> directions_in(const Planes& planes) {
  std::vector<Eigen::RowVector3d> directions;
  if (planes.empty()) {
    for (int k = 0; k < 3; ++k) directions.push_back(Eigen::RowVector3d::Unit(k));
  } else if (planes.size() == 1) {
    const Eigen::Vector3d normal = planes[0].normal.transpose();
    const Eigen::Vector3d along = normal.unitOrthogonal();
    directions = {along.transpose(), normal.cross(along).transpose()};
  } else if (planes.size() == 2) {
    const Eigen::RowVector3d edge = planes[0].normal.cross(planes[1].normal);
    if (edge.norm() > 0.1) directions.push_back(edge.normalized());
  }
  for (std::size_t i = directions.size(); i-- > 0;) directions.push_back(-directions[i]);
  return directions;
}

std::vector<std::vector<Eigen::RowVector3d>> ways_to_move(const TetMesh& mesh) {
  std::vector<std::vector<int>> faces(static_cast<std::size_t>(mesh.node_count()));
  for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
    for (const int i : mesh.faces.row(f)) faces[static_cast<std::size_t>(i)].push_back(f);
  }
  std::vector<std::vector<Eigen::RowVector3d>> ways;
  for (const auto& around : faces) ways.push_back(directions_in(planes_of(mesh, around)));
  return ways;
}

class Relaxer {
 public:
  Relaxer(TetMesh& mesh, double degrees)
      : mesh_(mesh),
        wanted_(degrees * std::numbers::pi / 180.0),
        star_(static_cast<std::size_t>(mesh.node_count())),
        directions_(ways_to_move(mesh)) {
    for (int t = 0; t < static_cast<int>(mesh.tet_count()); ++t) {
      for (const int i : mesh.tets.row(t)) star_[static_cast<std::size_t>(i)].push_back(t);
    }
    for (std::size_t i = 0; i < star_.size(); ++i) {
      for (const int t : star_[i]) {
        if (mesh.region[t] != mesh.region[star_[i][0]]) directions_[i].clear();
      }
    }
  }

  void run() {
    constexpr int sweeps = 5;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      std::set<int> nodes;
      for (int t = 0; t < static_cast<int>(mesh_.tet_count()); ++t) {
        if (worst_angle(t) >= wanted_) continue;
        for (const int i : mesh_.tets.row(t)) {
          if (!directions_[static_cast<std::size_t>(i)].empty()) nodes.insert(i);
        }
      }
      bool moved = false;
      for (const int i : nodes) moved = improved(i) || moved;
      if (!moved) return;
    }
  }

 private:
  // The smaller of the smallest dihedral angle and 180 degrees less the largest [rad]; negative
  // where the cell is inverted.
  [[nodiscard]] double worst_angle(int t) const {
    const auto corner = [&](int a) -> Eigen::Vector3d {
      return mesh_.points.row(mesh_.tets(t, a));
    };
    std::array<Eigen::Vector3d, 4> outward;
    for (std::size_t f = 0; f < 4; ++f) {
      const auto& [a, b, c] = kTetFaces[f];
      outward[f] = (corner(b) - corner(a)).cross(corner(c) - corner(a));
    }
    if (outward[0].dot(corner(2) - corner(0)) >= 0.0) return -1.0;
    double worst = std::numbers::pi;
    for (std::size_t f = 0; f < 4; ++f) {
      for (std::size_t g = 0; g < f; ++g) {
        const double turn =
            std::atan2(outward[f].cross(outward[g]).norm(), outward[f].dot(outward[g]));
        worst = std::min({worst, turn, std::numbers::pi - turn});
      }
    }
    return worst;
  }

  [[nodiscard]] double worst_around(int i) const {
    double worst = std::numbers::pi;
    for (const int t : star_[static_cast<std::size_t>(i)]) worst = std::min(worst, worst_angle(t));
    return worst;
  }

  [[nodiscard]] double shortest_edge(int i) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const int t : star_[static_cast<std::size_t>(i)]) {
      for (const int j : mesh_.tets.row(t)) {
        if (j == i) continue;
        shortest = std::min(shortest, (mesh_.points.row(j) - mesh_.points.row(i)).norm());
      }
    }
    return shortest;
  }

  bool improved(int i) {
    double reached = worst_around(i);
    const double before = reached;
    double step = 0.3 * shortest_edge(i);
    for (int shrink = 0; shrink < 6; ++shrink, step *= 0.5) {
      for (const Eigen::RowVector3d& direction : directions_[static_cast<std::size_t>(i)]) {
        const Eigen::RowVector3d here = mesh_.points.row(i);
        mesh_.points.row(i) += step * direction;
        const double now = worst_around(i);
        if (now > reached) {
          reached = now;
        } else {
          mesh_.points.row(i) = here;
        }
      }
    }
    return reached > before;
  }

  TetMesh& mesh_;
  double wanted_;
  std::vector<std::vector<int>> star_;
  std::vector<std::vector<Eigen::RowVector3d>> directions_;  // per node
};

}  // namespace

void relax(TetMesh& mesh, double degrees) { Relaxer(mesh, degrees).run(); }

}  // namespace chladni::mesh
