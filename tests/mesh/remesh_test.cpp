#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <ctime>
#include <limits>
#include <numbers>
#include <string>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/check.h"
#include "mesh/remesh/remesh.h"
#include "mesh/soundness/defects.h"
#include "mesh/soundness/shells.h"
#include "shapes.h"

namespace chladni::mesh {
namespace {

using shapes::box;
using shapes::cube;

void expect_sound(const Surface& surface) {
  Surface again = surface;
  const SurfaceReport report = check_and_repair(again);
  EXPECT_TRUE(report.findings.empty()) << report.text();
}

void expect_same_patches(const Surface& after, const Surface& before) {
  ASSERT_EQ(after.patch_names, before.patch_names);
  for (int p = 0; p < static_cast<int>(before.patch_names.size()); ++p) {
    const double area = shapes::patch_area(before.points, before.triangles, before.patch, p);
    EXPECT_NEAR(shapes::patch_area(after.points, after.triangles, after.patch, p), area,
                1e-9 * area);
  }
}

double longest_edge(const Surface& surface) {
  double longest = 0.0;
  for (const EdgeUse& use : edge_uses(surface.triangles)) {
    longest =
        std::max(longest, (surface.points.row(use.low) - surface.points.row(use.high)).norm());
  }
  return longest;
}

// 4 sqrt(3) area / sum of squared edges: 1 for an equilateral triangle.
double worst_shape(const Surface& surface) {
  double worst = 1.0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const Eigen::RowVector3d a = surface.points.row(surface.triangles(t, 0));
    const Eigen::RowVector3d b = surface.points.row(surface.triangles(t, 1));
    const Eigen::RowVector3d c = surface.points.row(surface.triangles(t, 2));
    const double area = 0.5 * Eigen::Vector3d(b - a).cross(Eigen::Vector3d(c - a)).norm();
    const double squares = (b - a).squaredNorm() + (c - a).squaredNorm() + (c - b).squaredNorm();
    worst = std::min(worst, 4.0 * std::sqrt(3.0) * area / squares);
  }
  return worst;
}

// CGAL promises an end only where the edges that stay are at most 4/3 of the wanted length.
TEST(Isotropic, RefusesKeptEdgesThatAreTooLong) {
  const Surface body = cube();
  const auto lengths = [&](double length) {
    return std::vector<double>(body.patch_names.size(), length);
  };
  EXPECT_TRUE(isotropic(body, {}, lengths(0.8)));
  EXPECT_FALSE(isotropic(body, {}, lengths(0.1)));
  auto one = lengths(0.0);
  EXPECT_TRUE(isotropic(body, {}, one));
  one.front() = 0.1;
  EXPECT_FALSE(isotropic(body, {}, one));
}

TEST(Remesh, KeepsVolumesAndPatches) {
  for (const Surface& body : {cube(), box({0, 0, 0}, {0.6, 0.6, 0.02}), shapes::tetrahedron()}) {
    const Surface after = remesh(body, 0.04);
    EXPECT_NEAR(enclosed_volume(after), enclosed_volume(body), 1e-12 * enclosed_volume(body));
    expect_same_patches(after, body);
    expect_sound(after);
    EXPECT_LT(longest_edge(after), 2.0 * 0.04);
  }
}

TEST(Remesh, KeepsATorusToAThousandth) {
  const Surface torus = shapes::torus(1.0, 0.3, 60, 30);
  const Surface after = remesh(torus, 0.08);
  EXPECT_NEAR(enclosed_volume(after), enclosed_volume(torus), 1e-3 * enclosed_volume(torus));
  expect_sound(after);
}

TEST(Remesh, TurnsSliversIntoGoodTriangles) {
  // A plate whose top is a fan of 400 slivers.
  Surface body = shapes::prism(0.0, 0.0, 0.15, 0.0, 0.02, 400);
  ASSERT_LT(worst_shape(body), 0.06);
  const Surface after = remesh(body, 0.01);
  EXPECT_GT(worst_shape(after), 0.1);
  EXPECT_NEAR(enclosed_volume(after), enclosed_volume(body), 1e-3 * enclosed_volume(body));
  expect_sound(after);
}

TEST(Remesh, KeepsADrilledHole) {
  const Surface drilled = difference(cube(), shapes::prism(0.5, 0.5, 0.2, -0.1, 1.1, 24));
  const Surface after = remesh(drilled, 0.06);
  EXPECT_NEAR(enclosed_volume(after), enclosed_volume(drilled), 1e-3);
  ASSERT_EQ(after.patch_names, drilled.patch_names);
  expect_sound(after);
}

TEST(Remesh, KeepsTheInterfaceOfBondedBodies) {
  const Surface body = bonded(box({0, 0, 0}, {1, 1, 0.3}), box({0.25, 0.2, 0.3}, {0.75, 0.9, 0.4}),
                              "table", "wafer");
  const Surface after = remesh(body, 0.07);
  expect_same_patches(after, body);
  Surface again = after;
  const SurfaceReport report = check_and_repair(again);
  EXPECT_TRUE(report.fit()) << report.text();
  EXPECT_NEAR(report.volume, 0.335, 1e-12);
  EXPECT_GT(after.triangles.rows(), 4 * body.triangles.rows());
  ASSERT_EQ(after.regions.size(), 2U);
}

// A block of width x length x 10 mm with a round of `radius` along one edge, in four facets.
Surface rounded_block(double width, double length, double radius) {
  constexpr int kFacets = 4;
  std::vector<Eigen::Vector2d> top{{0.0, 0.0}};
  for (int k = 0; k <= kFacets; ++k) {
    const double a = std::numbers::pi / 2.0 * (1.0 - static_cast<double>(k) / kFacets);
    top.emplace_back(width + radius * (std::cos(a) - 1.0), radius * (std::sin(a) - 1.0));
  }
  const int m = static_cast<int>(top.size());
  std::vector<Eigen::RowVector3d> points;
  for (const double y : {0.0, length}) {
    for (const auto& p : top) points.emplace_back(p.x(), y, p.y());
    for (const auto& p : top) points.emplace_back(p.x(), y, -0.01);
  }
  std::vector<Eigen::RowVector3i> triangles;
  const auto quad = [&](int a, int b, int c, int d) {
    triangles.emplace_back(a, b, c);
    triangles.emplace_back(a, c, d);
  };
  for (int i = 0; i + 1 < m; ++i) {
    quad(i, i + 1, 2 * m + i + 1, 2 * m + i);
    quad(m + i + 1, m + i, 3 * m + i, 3 * m + i + 1);
    quad(m + i, m + i + 1, i + 1, i);
    quad(2 * m + i, 2 * m + i + 1, 3 * m + i + 1, 3 * m + i);
  }
  quad(m, 0, 2 * m, 3 * m);
  quad(m - 1, 2 * m - 1, 4 * m - 1, 3 * m - 1);
  Surface block = shapes::surface_of(points, triangles);
  EXPECT_TRUE(check_and_repair(block).fit());
  return block;
}

// The slivers along a long round must not cost the square of its length: minutes before, a second
// now.
TEST(Remesh, OfALongThinRoundIsQuick) {
  const Surface block = rounded_block(0.2, 0.2, 0.3e-3);
  const std::clock_t begin = std::clock();
  const Surface after = remesh(block, 0.2 / 30.0);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 20.0);
  EXPECT_GT(after.triangles.rows(), 5000);
  EXPECT_NEAR(enclosed_volume(after), enclosed_volume(block), 1e-3 * enclosed_volume(block));
  expect_sound(after);
}

// The far corner of a plane beside a long round has as many triangles as the round has points.
// Their number must not count with its cube: 16 s to a minute before, a second now.
TEST(Remesh, OfFewestPlanesIsQuickBesideALongRound) {
  const Surface block = rounded_block(0.2, 0.2, 0.2e-3);
  const std::clock_t begin = std::clock();
  const Surface after = with_fewest_planes(block, 0.2 / 30.0);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 10.0);
  EXPECT_GT(after.triangles.rows(), 5000);
  EXPECT_NEAR(enclosed_volume(after), enclosed_volume(block), 1e-3 * enclosed_volume(block));
  expect_sound(after);
}

// Planes that are not renewed keep their triangles, and share their points with the others.
TEST(Remesh, LeavesThePatchesThatStayAsTheyAre) {
  const Surface block = rounded_block(0.2, 0.1, 5e-3);
  std::vector<double> lengths(block.patch_names.size(), 0.0);
  const std::optional<Surface> same = isotropic(block, {}, lengths);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->triangles.rows(), block.triangles.rows());
  EXPECT_EQ(same->points.rows(), block.points.rows());
  EXPECT_NEAR(enclosed_volume(*same), enclosed_volume(block), 1e-15);
  expect_sound(*same);
}

// What would take the memory is refused before it starts.
TEST(Remesh, RefusesMoreTrianglesThanAnybodyMeshes) {
  try {
    (void)remesh(cube(), 5e-4);
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("million triangles"), std::string::npos) << e.what();
  }
}

TEST(Remesh, RepeatsItsBits) {
  const Surface torus = shapes::torus(1.0, 0.3, 40, 20);
  const Surface first = remesh(torus, 0.1);
  for (int run = 0; run < 2; ++run) {
    const Surface again = remesh(torus, 0.1);
    EXPECT_TRUE(first.points == again.points);
    EXPECT_TRUE(first.triangles == again.triangles);
  }
}

TEST(Remesh, RefusesAnEdgeLengthThatIsNone) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)remesh(cube(), bad), InvalidInput);
  }
}

}  // namespace
}  // namespace chladni::mesh
