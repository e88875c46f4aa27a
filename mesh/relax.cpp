#include "mesh/relax.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace chladni::mesh {
namespace {

class Relaxer {
 public:
  Relaxer(TetMesh& mesh, double degrees)
      : mesh_(mesh),
        wanted_(degrees * std::numbers::pi / 180.0),
        star_(static_cast<std::size_t>(mesh.node_count())),
        free_(static_cast<std::size_t>(mesh.node_count()), 1) {
    for (int t = 0; t < static_cast<int>(mesh.tet_count()); ++t) {
      for (const int i : mesh.tets.row(t)) star_[static_cast<std::size_t>(i)].push_back(t);
    }
    for (const int i : mesh.faces.reshaped()) free_[static_cast<std::size_t>(i)] = 0;
    for (std::size_t i = 0; i < star_.size(); ++i) {
      for (const int t : star_[i]) {
        if (mesh.region[t] != mesh.region[star_[i][0]]) free_[i] = 0;
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
          if (free_[static_cast<std::size_t>(i)] == 1) nodes.insert(i);
        }
      }
      bool moved = false;
      for (const int i : nodes) moved = improved(i) || moved;
      if (!moved) return;
    }
  }

 private:
  // The smallest dihedral angle or 180 degrees less the largest, negative where it is inverted.
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
      for (int k = 0; k < 6; ++k) {
        const Eigen::RowVector3d here = mesh_.points.row(i);
        mesh_.points(i, k / 2) += k % 2 == 0 ? step : -step;
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
  std::vector<char> free_;
};

}  // namespace

void relax(TetMesh& mesh, double degrees) { Relaxer(mesh, degrees).run(); }

}  // namespace chladni::mesh
