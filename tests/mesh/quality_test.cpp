#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "mesh/tet_mesh.h"
#include "random_meshes.h"

namespace chladni::mesh {
namespace {

TetMesh one_tet(const Points& corners) {
  TetMesh mesh;
  mesh.points = corners;
  mesh.tets.resize(1, 4);
  mesh.tets << 0, 1, 2, 3;
  mesh.region = Eigen::VectorXi::Zero(1);
  mesh.region_names = {"body"};
  find_boundary(mesh);
  return mesh;
}

TetMesh regular() {
  Points corners(4, 3);
  corners << 1, 1, 1, -1, 1, -1, 1, -1, -1, -1, -1, 1;
  return one_tet(corners);
}

TEST(Quality, OfTheRegularTetrahedron) {
  const Quality q = quality(regular());
  EXPECT_NEAR(q.smallest_radius_ratio, 1.0, 1e-14);
  EXPECT_NEAR(q.mean_radius_ratio, 1.0, 1e-14);
  const double dihedral = std::acos(1.0 / 3.0) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(q.smallest_dihedral_degrees, dihedral, 1e-12);
  EXPECT_NEAR(q.largest_dihedral_degrees, dihedral, 1e-12);
  EXPECT_NEAR(q.shortest_edge, std::sqrt(8.0), 1e-14);
  EXPECT_NEAR(q.smallest_volume, 8.0 / 3.0, 1e-14);
  EXPECT_EQ(q.worst_tet, 0);
}

TEST(Quality, OfTheCornerOfACube) {
  Points corners(4, 3);
  corners << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const Quality q = quality(one_tet(corners));
  // r_in = 3V/A = (1/2) / (3/2 + sqrt(3)/2), r_circumscribed = sqrt(3)/2.
  EXPECT_NEAR(q.smallest_radius_ratio, 3.0 / (3.0 + std::sqrt(3.0)) / (std::sqrt(3.0) / 2.0),
              1e-14);
  EXPECT_NEAR(q.largest_dihedral_degrees, 90.0, 1e-12);
  EXPECT_NEAR(q.smallest_dihedral_degrees,
              std::acos(1.0 / std::sqrt(3.0)) * 180.0 / std::numbers::pi, 1e-12);
}

TEST(Quality, BlindToMotionAndScaleAndToTheOrder) {
  const TetMesh mesh = random_mesh(1);
  const Quality before = quality(mesh);
  TetMesh moved = with_order(mesh, 3);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  moved.points = 5.0 * moved.points * turn.transpose();
  moved.points.rowwise() += Eigen::RowVector3d(1, -2, 3);
  const Quality after = quality(moved);
  EXPECT_NEAR(after.smallest_radius_ratio, before.smallest_radius_ratio, 1e-12);
  EXPECT_NEAR(after.mean_radius_ratio, before.mean_radius_ratio, 1e-12);
  EXPECT_NEAR(after.smallest_dihedral_degrees, before.smallest_dihedral_degrees, 1e-9);
  EXPECT_NEAR(after.largest_dihedral_degrees, before.largest_dihedral_degrees, 1e-9);
  EXPECT_NEAR(after.smallest_volume, 125.0 * before.smallest_volume, 1e-12);
  EXPECT_NEAR(after.longest_edge, 5.0 * before.longest_edge, 1e-12);
  EXPECT_EQ(after.worst_tet, before.worst_tet);
  EXPECT_NEAR(volume(moved), 125.0 * 0.48, 1e-11);
}

TEST(Quality, FlatOnesAreZeroAndFound) {
  TetMesh mesh = random_mesh(2);
  for (const double height : {1e-3, 1e-6, 0.0}) {
    mesh.points.row(mesh.tets(11, 3)) =
        (mesh.points.row(mesh.tets(11, 0)) + mesh.points.row(mesh.tets(11, 1)) +
         mesh.points.row(mesh.tets(11, 2))) /
        3.0;
    mesh.points(mesh.tets(11, 3), 2) += height;
    const Quality q = quality(mesh);
    EXPECT_LT(q.smallest_radius_ratio, 0.1);
    EXPECT_GT(q.largest_dihedral_degrees, 170.0);
  }
}

TEST(Quality, OfNothingIsNothing) { EXPECT_EQ(quality(TetMesh{}).worst_tet, -1); }

TEST(Quality, RandomTetrahedraStayWithinTheirBounds) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  for (int trial = 0; trial < 1000; ++trial) {
    Points corners(4, 3);
    for (double& x : corners.reshaped()) x = coordinate(random);
    TetMesh mesh = one_tet(corners);
    if (volume(mesh) < 0.0) {
      corners.row(0).swap(corners.row(1));
      mesh = one_tet(corners);
    }
    const Quality q = quality(mesh);
    EXPECT_GE(q.smallest_radius_ratio, 0.0);
    EXPECT_LE(q.smallest_radius_ratio, 1.0);
    EXPECT_GT(q.smallest_dihedral_degrees, 0.0);
    EXPECT_LT(q.largest_dihedral_degrees, 180.0);
    EXPECT_LE(q.smallest_dihedral_degrees, 70.53);  // of the regular one
  }
}

}  // namespace
}  // namespace chladni::mesh
