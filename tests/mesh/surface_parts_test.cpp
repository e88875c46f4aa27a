// What the remesher is made of: parts, the lines between them, planes, volumes, flat cells.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "mesh/bodies.h"
#include "mesh/check.h"
#include "mesh/remesh/feature_lines.h"
#include "mesh/remesh/plane_triangles.h"
#include "mesh/remesh/restore_volumes.h"
#include "mesh/remesh/smooth_parts.h"
#include "mesh/tets/relax.h"
#include "rotation/turn.h"
#include "shapes.h"

namespace chladni::mesh {
namespace {

using shapes::box;
using shapes::prism;

Surface in_single_precision(Surface surface) {
  surface.points = surface.points.cast<float>().cast<double>();
  return surface;
}

Surface plate_with_hole(double radius, int sides) {
  return difference(box({0, 0, 0}, {0.3, 0.2, 0.02}), prism(0.1, 0.1, radius, -0.01, 0.03, sides));
}

std::vector<double> finite_radii(const SmoothParts& parts) {
  std::vector<double> radii;
  for (const double r : parts.radius) {
    if (std::isfinite(r)) radii.push_back(r);
  }
  return radii;
}

TEST(SmoothPartsOf, ABoxAreSixPlanes) {
  const SmoothParts parts = smooth_parts(shapes::cube(), 0.1, 30.0);
  EXPECT_EQ(parts.radius.size(), 6U);
  EXPECT_TRUE(finite_radii(parts).empty());
  EXPECT_EQ(parts.kept.size(), 12U);
}

TEST(SmoothPartsOf, ADrilledPlateKnowTheRadiusOfItsBore) {
  EVERY_FOURTH_LANDING();
  for (const int sides : {24, 90, 2000}) {
    const SmoothParts parts = smooth_parts(plate_with_hole(0.03, sides), 0.01, 30.0);
    EXPECT_EQ(parts.radius.size(), 7U) << sides;
    ASSERT_EQ(finite_radii(parts).size(), 1U) << sides;
    EXPECT_NEAR(finite_radii(parts)[0], 0.03, 0.0003) << sides;
  }
}

TEST(SmoothPartsOf, PlanesStayWholeWhereRoundingTiltsTheirSlivers) {
  EVERY_FOURTH_LANDING();
  const Surface rounded = in_single_precision(
      shapes::moved(plate_with_hole(0.03, 1885), {1.0, 2.0, 3.0}));  // sides of 0.1 mm x 20 mm
  Surface body = rounded;
  ASSERT_TRUE(check_and_repair(body).fit());
  EXPECT_EQ(smooth_parts(body, 0.01, 30.0).radius.size(), 7U);
}

TEST(SmoothPartsOf, ATorusIsOne) {
  const SmoothParts parts = smooth_parts(shapes::torus(0.3, 0.1, 200, 100), 0.04, 30.0);
  ASSERT_EQ(parts.radius.size(), 1U);
  EXPECT_TRUE(parts.kept.empty());
}

// A circle drawn as the rim of a prism: its two ends and the lines that stay on them.
std::vector<double> chords(const Surface& surface, const std::vector<EdgeUse>& kept,
                           const std::vector<int>& stand_in) {
  std::vector<double> lengths;
  for (const EdgeUse& edge : kept) {
    const int a = stand_in[static_cast<std::size_t>(edge.low)];
    const int b = stand_in[static_cast<std::size_t>(edge.high)];
    if (a != b) lengths.push_back((surface.points.row(a) - surface.points.row(b)).norm());
  }
  return lengths;
}

TEST(StandIns, DrawACircleWithEvenChords) {
  const double radius = 0.15;
  const Surface disc = prism(0, 0, radius, 0, 0.02, 997);
  const SmoothParts parts = smooth_parts(disc, 0.05, 30.0);
  for (const double longest : {0.01, 0.03, 0.07, 1.0}) {
    const Sampling sampling{longest, 0.002, std::numbers::pi / 4.0};
    const double wanted = chord_length(radius, sampling);
    const auto found = chords(disc, parts.kept, stand_ins(disc, parts.kept, sampling));
    const auto [low, high] = std::minmax_element(found.begin(), found.end());
    EXPECT_LT(*high, 1.3 * wanted) << longest;
    EXPECT_GT(*low, 0.6 * wanted) << longest;
    EXPECT_EQ(found.size() % 2, 0U);  // both rims alike
  }
}

TEST(StandIns, KeepCornersAndBranches) {
  const Surface cube = remesh(shapes::cube(), 0.1);
  const SmoothParts parts = smooth_parts(cube, 0.5, 30.0);
  const std::vector<int> stand_in = stand_ins(cube, parts.kept, {10.0, 1.0, 1.0});
  std::set<int> left;
  for (const EdgeUse& edge : parts.kept) {
    left.insert(stand_in[static_cast<std::size_t>(edge.low)]);
    left.insert(stand_in[static_cast<std::size_t>(edge.high)]);
  }
  EXPECT_EQ(left.size(), 8U);
  for (const int i : left) {
    for (const double x : cube.points.row(i)) EXPECT_TRUE(x == 0.0 || x == 1.0);
  }
}

TEST(StandIns, LeaveAlonePointsOffTheLines) {
  const Surface torus = shapes::torus(0.3, 0.1, 40, 20);
  const std::vector<int> stand_in = stand_ins(torus, {}, {1.0, 1.0, 1.0});
  for (std::size_t i = 0; i < stand_in.size(); ++i) EXPECT_EQ(stand_in[i], static_cast<int>(i));
}

double facing_area(const Points& points, const std::vector<Eigen::Vector3i>& triangles,
                   const Eigen::RowVector3d& normal) {
  double sum = 0.0;
  for (const Eigen::Vector3i& t : triangles) {
    const Eigen::RowVector3d a = points.row(t[0]);
    const Eigen::RowVector3d b = points.row(t[1]);
    const Eigen::RowVector3d c = points.row(t[2]);
    sum += 0.5 * (b - a).cross(c - a).dot(normal.normalized());
  }
  return sum;
}

TEST(PlaneTriangles, LeaveHolesOpenAndSeeTheNormal) {
  Points points(8, 3);
  points << 0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, 1, 1, 0, 3, 1, 0, 3, 3, 0, 1, 3, 0;
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  points = (points * turn.toRotationMatrix().transpose()).eval();
  std::vector<PlaneLine> rim;
  for (const int base : {0, 4}) {
    for (int i = 0; i < 4; ++i) rim.push_back({base + i, base + (i + 1) % 4, 1});
  }
  for (const double side : {1.0, -1.0}) {
    const Eigen::RowVector3d normal = side * (turn * Eigen::Vector3d::UnitZ()).transpose();
    const auto found = plane_triangles(points, {}, rim, normal);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(facing_area(points, *found, normal), 12.0, 1e-12);
  }
}

TEST(PlaneTriangles, KeepALineWithTheFigureOnBothSides) {
  Points points(6, 3);
  points << 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 0.5, 1, 0, 1.5, 1.2, 0;
  const std::vector<PlaneLine> rim{{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {3, 0, 1}, {4, 5, 2}};
  const auto found = plane_triangles(points, {}, rim, {0, 0, 1});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(facing_area(points, *found, {0, 0, 1}), 4.0, 1e-12);
  int uses = 0;
  for (const Eigen::Vector3i& t : *found) {
    uses += static_cast<int>((t.array() == 4).any() && (t.array() == 5).any());
  }
  EXPECT_EQ(uses, 2);
}

TEST(PlaneTriangles, AreNoneWhereLinesCross) {
  Points points(4, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0;
  const std::vector<PlaneLine> rim{{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {3, 0, 1}};
  EXPECT_FALSE(plane_triangles(points, {}, rim, {0, 0, 1}).has_value());
}

TEST(RestoreVolumes, UndoesAShrunkTorus) {
  const Surface torus = shapes::torus(0.3, 0.1, 60, 30);
  Surface thin = shapes::torus(0.3, 0.098, 60, 30);
  restore_volumes(thin, torus, {0.01});
  EXPECT_NEAR(enclosed_volume(thin), enclosed_volume(torus), 1e-5 * enclosed_volume(torus));
  Surface held = shapes::torus(0.3, 0.098, 60, 30);
  restore_volumes(held, torus, {0.0});
  EXPECT_EQ(enclosed_volume(held), enclosed_volume(shapes::torus(0.3, 0.098, 60, 30)));
}

// Per axis whether a point lies on a face of the plate below.
std::array<bool, 3> has_plane(const Eigen::RowVector3d& p) {
  return {std::abs(p.x()) == 0.2, std::abs(p.y()) == 0.15, p.z() == 0.0 || p.z() == -0.2};
}

TEST(Relax, RaisesTheWorstAngleOfTheSameBody) {
  TetMesh mesh = layered(Plate{0.4, 0.3, 0.2}, 0.05, 4);
  std::set<int> rim;
  for (const int i : mesh.faces.reshaped()) rim.insert(i);
  int inner = -1;
  for (int i = 0; i < mesh.node_count() && inner < 0; ++i) {
    if (!rim.contains(i)) inner = i;
  }
  ASSERT_GE(inner, 0);
  mesh.points.row(inner) += Eigen::RowVector3d(0.03, 0.02, -0.012);
  const TetMesh before = mesh;
  ASSERT_LT(quality(before).smallest_dihedral_degrees, 20.0);
  relax(mesh, 25.0);
  EXPECT_GT(quality(mesh).smallest_dihedral_degrees,
            quality(before).smallest_dihedral_degrees + 5.0);
  EXPECT_NEAR(volume(mesh), volume(before), 1e-12);
  for (const int i : rim) {
    EXPECT_EQ(has_plane(mesh.points.row(i)), has_plane(before.points.row(i)));
  }
  for (int p = 0; p < static_cast<int>(mesh.patch_names.size()); ++p) {
    EXPECT_NEAR(shapes::patch_area(mesh.points, mesh.faces, mesh.face_patch, p),
                shapes::patch_area(before.points, before.faces, before.face_patch, p), 1e-12);
  }
}

TEST(Relax, LeavesCurvedBoundariesAndRegionsWhereTheyAre) {
  TetMesh ball = layered(Sphere{0.1, 0.0}, 0.04);
  project_to_sphere(ball, Sphere{0.1, 0.0});
  const TetMesh before = ball;
  relax(ball, 60.0);
  for (const int i : ball.faces.reshaped()) {
    EXPECT_TRUE(ball.points.row(i) == before.points.row(i));
  }
  TetMesh two = layered(Plate{0.4, 0.3, 0.2}, 0.1, 2);
  two.region_names = {"left", "right"};
  for (Eigen::Index t = 0; t < two.tet_count(); ++t) {
    double x = 0.0;
    for (const int i : two.tets.row(t)) x += two.points(i, 0);
    two.region[t] = x < 0.0 ? 0 : 1;
  }
  const auto left = [&] {
    TetMesh part = two;
    for (Eigen::Index t = 0; t < part.tet_count(); ++t) {
      if (two.region[t] == 1) part.tets.row(t).setConstant(two.tets(t, 0));
    }
    return volume(part);
  };
  const double volume_before = left();
  relax(two, 60.0);
  EXPECT_NEAR(left(), volume_before, 1e-12);
}

}  // namespace
}  // namespace chladni::mesh
