// Laws that every mesh of ours obeys, whatever the body.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

inline Eigen::Vector3d area_vector(const Points& points, const Cells& faces, Eigen::Index f) {
  const Eigen::Vector3d a = points.row(faces(f, 0));
  const Eigen::Vector3d b = points.row(faces(f, 1));
  const Eigen::Vector3d c = points.row(faces(f, 2));
  return (b - a).cross(c - a) / 2.0;
}

inline Surface as_surface(const TetMesh& mesh) {
  Surface surface;
  surface.points = mesh.points;
  surface.triangles = mesh.faces.leftCols(3);
  surface.patch = mesh.face_patch;
  surface.patch_names = mesh.patch_names;
  return surface;
}

/// Every edge is walked once in each direction: closed, oriented, without T-junctions.
inline void expect_closed(const Surface& surface) {
  std::set<std::pair<int, int>> open;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      const int from = surface.triangles(t, a);
      const int to = surface.triangles(t, (a + 1) % 3);
      ASSERT_NE(from, to);
      if (open.erase({to, from}) == 0) {
        ASSERT_TRUE(open.emplace(from, to).second) << "edge walked twice the same way";
      }
    }
  }
  EXPECT_TRUE(open.empty());
}

inline std::array<int, 3> sorted_corners(const Cells& faces, Eigen::Index f) {
  std::array<int, 3> key{faces(f, 0), faces(f, 1), faces(f, 2)};
  std::sort(key.begin(), key.end());
  return key;
}

/// The faces are those that only one tetrahedron has, seen from outside, and enclose the volume.
inline void expect_sound(const TetMesh& mesh) {
  ASSERT_NO_THROW(check(mesh));
  TetMesh again = mesh;
  find_boundary(again);
  ASSERT_EQ(again.faces.rows(), mesh.faces.rows());
  std::set<std::array<int, 3>> own, found;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    own.insert(sorted_corners(mesh.faces, f));
    found.insert(sorted_corners(again.faces, f));
  }
  EXPECT_EQ(own, found);
  expect_closed(as_surface(mesh));
  const double v = volume(mesh);
  EXPECT_NEAR(enclosed_volume(as_surface(mesh)), v, 1e-12 * v);
  EXPECT_NEAR(enclosed_volume(as_surface(again)), v, 1e-12 * v);
}

inline double patch_area(const Surface& surface, const std::string& name) {
  double area = 0.0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (surface.patch_names[static_cast<std::size_t>(surface.patch(t))] != name) continue;
    area += area_vector(surface.points, surface.triangles, t).norm();
  }
  return area;
}

/// The cells of `mesh` as sets of rounded corner positions, after `move` of each corner.
template <typename Move>
std::multiset<std::multiset<std::array<long long, 3>>> cells_after(const TetMesh& mesh,
                                                                   const Move& move) {
  std::multiset<std::multiset<std::array<long long, 3>>> cells;
  for (const auto tet : mesh.tets.rowwise()) {
    std::multiset<std::array<long long, 3>> corners;
    for (Eigen::Index a = 0; a < 4; ++a) {
      const Eigen::Vector3d at = move(Eigen::Vector3d(mesh.points.row(tet(a))));
      corners.insert(
          {std::llround(1e9 * at.x()), std::llround(1e9 * at.y()), std::llround(1e9 * at.z())});
    }
    cells.insert(corners);
  }
  return cells;
}

/// `move` maps the mesh onto itself, cell by cell.
template <typename Move>
bool symmetric_under(const TetMesh& mesh, const Move& move) {
  return cells_after(mesh, [](const Eigen::Vector3d& p) { return p; }) == cells_after(mesh, move);
}

}  // namespace chladni::mesh
