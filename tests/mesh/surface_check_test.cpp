#include <gtest/gtest.h>

#include <limits>

#include "mesh/check.h"
#include "shapes.h"

namespace chladni::mesh {
namespace {

using shapes::box;
using shapes::cube;
using Severity = Finding::Severity;

// The findings of one severity, joined.
std::string said(const SurfaceReport& report, Severity severity) {
  std::string text;
  for (const Finding& finding : report.findings) {
    if (finding.severity == severity) text += finding.what + "; " + finding.remedy + "\n";
  }
  return text;
}

void expect_said(const SurfaceReport& report, Severity severity,
                 const std::vector<std::string>& words) {
  const std::string text = said(report, severity);
  for (const std::string& word : words) {
    EXPECT_NE(text.find(word), std::string::npos) << "\"" << word << "\" is not in: " << text;
  }
}

void expect_refused(Surface surface, const std::vector<std::string>& words) {
  const SurfaceReport report = check_and_repair(surface);
  EXPECT_FALSE(report.fit()) << report.text();
  expect_said(report, Severity::refused, words);
}

TEST(CheckAndRepair, FindsNothingInSoundBodies) {
  Surface soap = cube(0.1);
  const SurfaceReport report = check_and_repair(soap);
  EXPECT_TRUE(report.findings.empty()) << report.text();
  EXPECT_TRUE(report.fit());
  EXPECT_DOUBLE_EQ(report.volume, 1e-3);
  EXPECT_NEAR(report.area, 0.06, 1e-15);
  EXPECT_EQ(report.bodies, 1);
}

TEST(CheckAndRepair, KnowsVolumes) {
  Surface tetrahedron = shapes::tetrahedron();
  EXPECT_NEAR(check_and_repair(tetrahedron).volume, 1.0 / 6.0, 1e-15);
  Surface torus = shapes::torus(1.0, 0.25, 96, 48);
  const double exact = 2.0 * std::pow(std::numbers::pi * 0.25, 2);
  EXPECT_NEAR(check_and_repair(torus).volume, exact, 0.006 * exact);
}

TEST(CheckAndRepair, MergesTheSoupOfAnStlFile) {
  Surface soup = shapes::as_soup(cube());
  const SurfaceReport report = check_and_repair(soup);
  EXPECT_TRUE(report.fit()) << report.text();
  EXPECT_EQ(soup.points.rows(), 8);
  expect_said(report, Severity::repaired, {"merged 28 duplicate points"});
}

TEST(CheckAndRepair, MergesPointsThatDifferInTheLastDigits) {
  Surface soup = shapes::as_soup(cube());
  for (Eigen::Index i = 0; i < soup.points.rows(); ++i)
    soup.points(i, i % 3) += i % 2 == 0 ? 0.0 : 1e-11;
  EXPECT_TRUE(check_and_repair(soup).fit());
  EXPECT_EQ(soup.points.rows(), 8);
}

TEST(CheckAndRepair, TurnsWhatIsInsideOut) {
  Surface body = cube();
  for (Eigen::Index t = 0; t < 12; ++t) shapes::turn(body, t);
  ASSERT_LT(enclosed_volume(body), 0.0);
  const SurfaceReport report = check_and_repair(body);
  EXPECT_DOUBLE_EQ(enclosed_volume(body), 1.0);
  expect_said(report, Severity::repaired, {"inside out"});
}

TEST(CheckAndRepair, OrientsAMixedSurface) {
  Surface body = cube();
  for (const Eigen::Index t : {1, 4, 9}) shapes::turn(body, t);
  const SurfaceReport report = check_and_repair(body);
  EXPECT_TRUE(report.fit());
  EXPECT_DOUBLE_EQ(enclosed_volume(body), 1.0);
  expect_said(report, Severity::repaired, {"3 of 12 triangles faced the wrong way"});
}

TEST(CheckAndRepair, RemovesDuplicateTrianglesAndUnusedPoints) {
  Surface body = shapes::both(
      cube(), shapes::surface_of({{0, 0, 0}, {0, 1, 1}, {0, 0, 1}, {5, 5, 5}}, {{0, 1, 2}}));
  const SurfaceReport report = check_and_repair(body);
  EXPECT_TRUE(report.fit()) << report.text();
  EXPECT_EQ(body.triangles.rows(), 12);
  EXPECT_EQ(body.patch.size(), 12);
  expect_said(report, Severity::repaired,
              {"removed 1 duplicate triangle", "removed 1 unused point"});
  expect_said(report, Severity::note, {"more than 1 %"});
}

TEST(CheckAndRepair, RemovesATriangleWithoutAreaAndStaysClosed) {
  // The middle of an edge hangs on a flat triangle on one side and on none on the other.
  Surface body = cube();
  body.points.conservativeResize(9, 3);
  body.points.row(8) << 0.5, 0.0, 0.0;  // between 0 and 1
  body.triangles.conservativeResize(14, 3);
  body.patch.conservativeResize(14);
  body.triangles.row(9) << 0, 3, 8;  // (0 3 1) in two
  body.triangles.row(12) << 8, 3, 1;
  body.triangles.row(13) << 0, 8, 1;  // flat
  body.patch[12] = body.patch[9];
  body.patch[13] = body.patch[9];
  const SurfaceReport report = check_and_repair(body);
  EXPECT_TRUE(report.fit()) << report.text();
  EXPECT_EQ(body.triangles.rows(), 14);
  EXPECT_DOUBLE_EQ(report.volume, 1.0);
  expect_said(report, Severity::repaired, {"degenerate"});
  EXPECT_NEAR(shapes::patch_area(body.points, body.triangles, body.patch, 2), 1.0, 1e-15);
}

TEST(CheckAndRepair, RefusesAnOpenSurfaceAndSaysWhere) {
  Surface open = cube(0.1);
  open.triangles.conservativeResize(10, 3);  // z_max is missing
  open.patch.conservativeResize(10);
  expect_refused(open, {"open: 1 hole", "(50, 50, 100) mm, 4 edges", "repair = \"fill\""});
}

TEST(CheckAndRepair, CountsTheHolesOfAMixedSurface) {
  Surface open = cube(0.1);
  shapes::turn(open, 5);
  open.triangles.row(0) = open.triangles.row(11);
  open.triangles.row(2) = open.triangles.row(10);
  open.triangles.conservativeResize(10, 3);
  open.patch.conservativeResize(10);
  expect_refused(open, {"open: 2 holes", "3 edges"});
}

TEST(CheckAndRepair, FillsHolesOnlyOnRequest) {
  Surface open = cube();
  open.triangles.conservativeResize(10, 3);
  open.patch.conservativeResize(10);
  RepairOptions fill;
  fill.fill_holes = true;
  const SurfaceReport report = check_and_repair(open, fill);
  EXPECT_TRUE(report.fit()) << report.text();
  EXPECT_DOUBLE_EQ(report.volume, 1.0);
  EXPECT_EQ(open.patch_names.back(), "filled");
  expect_said(report, Severity::repaired, {"1 hole filled with 2 triangles"});
}

TEST(CheckAndRepair, LeavesHolesThatAreTooLarge) {
  Surface open = cube();
  open.triangles.conservativeResize(10, 3);
  open.patch.conservativeResize(10);
  RepairOptions fill;
  fill.fill_holes = true;
  fill.largest_hole_edges = 3;
  const SurfaceReport report = check_and_repair(open, fill);
  EXPECT_FALSE(report.fit());
  expect_said(report, Severity::refused, {"4 edges", "too large"});
}

TEST(CheckAndRepair, RefusesNonManifoldEdgesAndPointsWithTheirPlaces) {
  expect_refused(shapes::both(cube(), box({1, 1, 0}, {2, 2, 1})),  // along an edge
                 {"1 edge with more than two triangles", "(1000, 1000, 0) mm", "unite"});
  expect_refused(shapes::both(cube(), box({1, 1, 1}, {2, 2, 2})),  // at a point
                 {"1 point where parts touch", "(1000, 1000, 1000) mm"});
}

TEST(CheckAndRepair, RefusesASurfaceThatIntersectsItself) {
  expect_refused(shapes::both(cube(), box({0.3, 0.4, 0.5}, {0.6, 0.7, 1.5})),
                 {"intersects itself", "near (", "mm", "unite"});
}

TEST(CheckAndRepair, NamesAtMostTenCrossings) {
  Surface grid = cube(10.0);
  for (int i = 0; i < 12; ++i) {
    grid = shapes::both(grid, box({i * 0.7 + 0.5, 4.1, 9.0}, {i * 0.7 + 0.9, 4.9, 11.0}));
  }
  Surface again = grid;
  const SurfaceReport report = check_and_repair(grid);
  expect_said(report, Severity::refused, {"more"});
  const std::string text = said(report, Severity::refused);
  std::size_t places = 0;
  for (auto at = text.find(" near ("); at != std::string::npos; at = text.find(" near (", at + 1)) {
    ++places;
  }
  EXPECT_EQ(places, 10U);
  EXPECT_EQ(check_and_repair(again).text(), report.text());
}

TEST(CheckAndRepair, FindsATriangleFoldedOntoItsNeighbour) {
  Surface folded =
      shapes::surface_of({{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.5, 0}, {0.5, 0.4, 1}},
                         {{0, 1, 2}, {1, 0, 3}, {0, 2, 4}, {2, 1, 4}, {0, 4, 3}, {1, 3, 4}});
  expect_refused(folded, {"intersects itself", "0 and 1 near"});
}

TEST(CheckAndRepair, RefusesBodiesWithoutThickness) {
  expect_refused(box({0, 0, 0}, {1, 1, 0}), {"volume 0", "one plane", "thickness"});
  expect_refused(box({0, 0, 0}, {0.6, 0.6, 1e-6}), {"walls of 0.001 mm", "848.5 mm"});
}

TEST(CheckAndRepair, RefusesPointsThatAreNotFinite) {
  Surface body = cube();
  body.points(3, 1) = std::numeric_limits<double>::quiet_NaN();
  body.points(7, 2) = std::numeric_limits<double>::infinity();
  expect_refused(body, {"2 points not finite", "number 3, 7"});
}

TEST(CheckAndRepair, RefusesWhatIsNoSurface) {
  expect_refused(Surface{}, {"no triangles"});
  Surface body = cube();
  body.triangles(4, 1) = 99;
  expect_refused(body, {"there is none of: 4", "0 to 7"});
  body = cube();
  body.patch.conservativeResize(5);
  expect_refused(body, {"5 patches for 12 triangles"});
}

TEST(CheckAndRepair, RefusesBodiesThatDoNotTouchAndListsThem) {
  expect_refused(
      shapes::both(cube(), box({2, 0, 0}, {3, 1, 2})),
      {"2 bodies that do not touch", "1e+09 mm^3", "2e+09 mm^3", "(2500, 500, 1000) mm"});
}

TEST(CheckAndRepair, TakesAShellInsideAnotherForAVoid) {
  for (const bool turned : {false, true}) {
    Surface inner = box({0.2, 0.2, 0.2}, {0.7, 0.7, 0.7});
    for (Eigen::Index t = 0; turned && t < 12; ++t) shapes::turn(inner, t);
    Surface hollow = shapes::both(cube(), inner);
    const SurfaceReport report = check_and_repair(hollow);
    EXPECT_TRUE(report.fit()) << report.text();
    EXPECT_NEAR(report.volume, 1.0 - 0.125, 1e-15);
    EXPECT_NEAR(enclosed_volume(hollow), 1.0 - 0.125, 1e-15);
    expect_said(report, Severity::note, {"1 closed void"});
  }
}

TEST(CheckAndRepair, AsksAboutTheUnit) {
  Surface large = box({0, 0, 0}, {600, 600, 20});
  expect_said(check_and_repair(large), Severity::note, {"600 m long", "is the unit right?"});
  Surface small = box({0, 0, 0}, {6e-4, 6e-4, 2e-5});
  expect_said(check_and_repair(small), Severity::note, {"0.6 mm long", "is the unit right?"});
}

TEST(CheckAndRepair, SaysThatDigitsAreLostFarFromTheOrigin) {
  Surface far = shapes::moved(cube(), {1e9, 0, 0});
  const SurfaceReport report = check_and_repair(far);
  EXPECT_TRUE(report.fit()) << report.text();
  EXPECT_NEAR(report.volume, 1.0, 1e-6);
  expect_said(report, Severity::note, {"1e+09 m from the origin", "9 of 16 digits"});
}

TEST(CheckAndRepair, IsTheSameInAnyUnitAndOrder) {
  const Surface torus = shapes::torus(1.0, 0.3, 24, 12);
  Surface metre = torus;
  Surface small = shapes::scaled(torus, 0.01);
  small.triangles.colwise().reverseInPlace();
  EXPECT_NEAR(check_and_repair(metre).volume, 1e6 * check_and_repair(small).volume, 1e-12);
}

}  // namespace
}  // namespace chladni::mesh
