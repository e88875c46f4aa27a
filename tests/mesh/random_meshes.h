// Small meshes without structure, from a fixed seed.
#pragma once

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "mesh/bodies.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// A block whose inner corners are moved at random and whose nodes, cells and corners are shuffled
/// (keeping each cell's orientation); boundary found again.
inline TetMesh random_mesh(unsigned seed) {
  std::mt19937 random(seed);
  TetMesh mesh = layered(Plate{1.0, 0.8, 0.6}, 0.25, 3);
  std::vector<bool> fixed(static_cast<std::size_t>(mesh.points.rows()), false);
  for (const auto face : mesh.faces.rowwise()) {
    for (const int p : face) fixed[static_cast<std::size_t>(p)] = true;
  }
  std::uniform_real_distribution<double> shift(-0.03, 0.03);
  for (Eigen::Index p = 0; p < mesh.points.rows(); ++p) {
    if (fixed[static_cast<std::size_t>(p)]) continue;
    for (Eigen::Index axis = 0; axis < 3; ++axis) mesh.points(p, axis) += shift(random);
  }
  std::vector<int> fresh(static_cast<std::size_t>(mesh.points.rows()));
  std::iota(fresh.begin(), fresh.end(), 0);
  std::shuffle(fresh.begin(), fresh.end(), random);
  const Points old = mesh.points;
  for (std::size_t p = 0; p < fresh.size(); ++p) {
    mesh.points.row(fresh[p]) = old.row(static_cast<Eigen::Index>(p));
  }
  for (auto tet : mesh.tets.rowwise()) {
    for (int& p : tet) p = fresh[static_cast<std::size_t>(p)];
    const int a = static_cast<int>(random() % 4);
    std::swap(tet(a), tet((a + 1) % 4));  // two swaps: an even permutation
    std::swap(tet((a + 2) % 4), tet((a + 3) % 4));
  }
  for (Eigen::Index t = mesh.tets.rows() - 1; t > 0; --t) {
    const auto other = static_cast<Eigen::Index>(random() % static_cast<unsigned>(t + 1));
    mesh.tets.row(t).swap(mesh.tets.row(other));
  }
  find_boundary(mesh);
  return mesh;
}

}  // namespace chladni::mesh
