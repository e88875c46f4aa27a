#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "mesh/check.h"
#include "mesh/patches.h"
#include "mesh/soundness/shells.h"
#include "shapes.h"

namespace chladni::mesh {
namespace {

using shapes::box;
using shapes::cube;

int patch_named(const Surface& surface, const std::string& name) {
  const auto at = std::find(surface.patch_names.begin(), surface.patch_names.end(), name);
  EXPECT_NE(at, surface.patch_names.end()) << name;
  return static_cast<int>(at - surface.patch_names.begin());
}

double area(const Surface& surface, const std::string& name) {
  return shapes::patch_area(surface.points, surface.triangles, surface.patch,
                            patch_named(surface, name));
}

// Area of a regular polygon.
double polygon(int sides, double radius) {
  return 0.5 * sides * radius * radius * std::sin(2.0 * std::numbers::pi / sides);
}

TEST(Difference, DrillsACube) {
  const Surface drilled = difference(cube(), shapes::prism(0.5, 0.5, 0.2, -0.1, 1.1, 24));
  Surface again = drilled;
  EXPECT_TRUE(check_and_repair(again).fit());
  EXPECT_NEAR(enclosed_volume(drilled), 1.0 - polygon(24, 0.2), 1e-12);
  EXPECT_NEAR(area(drilled, "z_max"), 1.0 - polygon(24, 0.2), 1e-12);
  EXPECT_NEAR(area(drilled, "z_min"), 1.0 - polygon(24, 0.2), 1e-12);
  EXPECT_NEAR(area(drilled, "x_min"), 1.0, 1e-12);
  const double around = 24.0 * 2.0 * 0.2 * std::sin(std::numbers::pi / 24.0);
  EXPECT_NEAR(area(drilled, "bore"), around, 1e-12);
}

TEST(Difference, CutsAPocketThatIsFlushWithTheFace) {
  const Surface cut = difference(cube(), box({0.2, 0.3, 0.0}, {0.7, 0.6, 0.5}));
  EXPECT_NEAR(enclosed_volume(cut), 1.0 - 0.075, 1e-12);
  EXPECT_NEAR(area(cut, "z_min"), 1.0 - 0.15, 1e-12);
}

TEST(Difference, RefusesToLeaveNothing) {
  EXPECT_THROW((void)difference(cube(), box({-1, -1, -1}, {2, 2, 2})), InvalidInput);
}

TEST(United, IsInclusionAndExclusion) {
  const Surface a = cube();
  const Surface b = box({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5});
  EXPECT_NEAR(enclosed_volume(united(a, b)), 2.0 - 0.125, 1e-12);
  EXPECT_NEAR(enclosed_volume(united(b, a)), 2.0 - 0.125, 1e-12);
  EXPECT_NEAR(enclosed_volume(difference(a, b)), 1.0 - 0.125, 1e-12);
}

TEST(United, JoinsBodiesThatTouchAlongAFace) {
  const Surface stacked = united(cube(), box({0, 0, 1}, {1, 1, 3}));
  EXPECT_NEAR(enclosed_volume(stacked), 3.0, 1e-12);
  EXPECT_NEAR(area(stacked, "x_min"), 3.0, 1e-12);
  EXPECT_NEAR(area(stacked, "z_max"), 1.0, 1e-12);
}

TEST(United, RefusesBodiesThatTouchAlongAnEdge) {
  EXPECT_THROW((void)united(cube(), box({1, 1, 0}, {2, 2, 1})), InvalidInput);
}

TEST(Booleans, RefuseOpenAndCrossedBodiesByName) {
  Surface open = cube();
  open.triangles.conservativeResize(10, 3);
  open.patch.conservativeResize(10);
  const Surface crossed = shapes::both(cube(), box({0.3, 0.4, 0.5}, {0.6, 0.7, 1.5}));
  for (const Surface& bad : {open, crossed}) {
    try {
      (void)united(cube(), bad);
      FAIL() << "no exception";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("second body"), std::string::npos) << error.what();
    }
    EXPECT_THROW((void)difference(bad, cube()), InvalidInput);
    EXPECT_THROW((void)bonded(bad, cube(), "a", "b"), InvalidInput);
  }
}

TEST(Bonded, HasTheCommonFaceOnceAndTwoRegions) {
  const Surface table = box({0, 0, 0}, {1, 1, 0.3});
  const Surface wafer = box({0.25, 0.2, 0.3}, {0.75, 0.9, 0.4});
  const Surface both = bonded(table, wafer, "table", "wafer");
  ASSERT_EQ(both.regions.size(), 2U);
  EXPECT_EQ(both.regions[0].name, "table");
  EXPECT_EQ(both.regions[1].name, "wafer");
  EXPECT_NEAR(area(both, "interface_wafer"), 0.35, 1e-12);
  EXPECT_NEAR(area(both, "z_max"), 1.0 - 0.35 + 0.35, 1e-12);  // table's rest, wafer's top
  Surface again = both;
  const SurfaceReport report = check_and_repair(again);
  EXPECT_TRUE(report.fit()) << report.text();
  EXPECT_NEAR(report.volume, 0.3 + 0.035, 1e-12);
  EXPECT_EQ(report.bodies, 1);
}

TEST(Bonded, ImprintsFacesThatOverlapInPart) {
  const Surface both =
      bonded(cube(), box({0.4, -0.5, 1.0}, {1.4, 0.3, 1.2}), "lower", "upper");  // overhanging
  EXPECT_NEAR(area(both, "interface_upper"), 0.6 * 0.3, 1e-12);
  Surface again = both;
  EXPECT_NEAR(check_and_repair(again).volume, 1.0 + 0.16, 1e-12);
}

TEST(Bonded, ImprintsARoundWafer) {
  const Surface both = bonded(box({-1, -1, -0.2}, {1, 1, 0}),
                              shapes::prism(0.1, -0.1, 0.6, 0.0, 0.05, 48), "table", "wafer");
  EXPECT_NEAR(area(both, "interface_wafer"), polygon(48, 0.6), 1e-12);
}

TEST(Bonded, FindsPointsWellInside) {
  const Surface both =
      bonded(box({0, 0, 0}, {1, 1, 0.01}), box({0, 0, 0.01}, {1, 1, 0.011}), "a", "b");
  EXPECT_NEAR(both.regions[0].inside.z(), 0.005, 1e-6);
  EXPECT_NEAR(both.regions[1].inside.z(), 0.0105, 1e-6);
}

TEST(Bonded, RefusesBodiesThatOverlapOrAreApart) {
  EXPECT_THROW((void)bonded(cube(), box({2, 0, 0}, {3, 1, 1}), "a", "b"), InvalidInput);
  EXPECT_THROW((void)bonded(cube(), box({0.2, 0.2, 0.5}, {0.8, 0.8, 1.5}), "a", "b"), InvalidInput);
}

TEST(BoundingPatches, LeaveOutThoseBetweenRegions) {
  const Surface both =
      bonded(box({0, 0, 0}, {1, 1, 0.3}), box({0.25, 0.2, 0.3}, {0.75, 0.9, 0.4}), "a", "wafer");
  const std::vector<char> bounds = bounding_patches(both);
  ASSERT_EQ(bounds.size(), both.patch_names.size());
  const auto between = static_cast<std::size_t>(patch_named(both, "interface_wafer"));
  for (std::size_t p = 0; p < bounds.size(); ++p) {
    EXPECT_EQ(bounds[p], p == between ? 0 : 1) << both.patch_names[p];
  }
}

TEST(WindingNumber, CountsBodies) {
  const Surface body = cube();
  const std::vector<int> all(12, 1);
  EXPECT_NEAR(winding_number(body, all, {0.3, 0.5, 0.9}), 1.0, 1e-12);
  EXPECT_NEAR(winding_number(body, all, {1.3, 0.5, 0.9}), 0.0, 1e-12);
}

}  // namespace
}  // namespace chladni::mesh
