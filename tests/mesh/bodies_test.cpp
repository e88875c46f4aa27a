#include "mesh/bodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/error.h"
#include "mesh/check.h"
#include "shape_laws.h"

namespace chladni::mesh {
namespace {

constexpr double kPi = std::numbers::pi;

const WaferTable kReference{.length = 0.6,
                            .width = 0.6,
                            .height = 0.05,
                            .face_sheet = 0.008,
                            .pockets_x = 9,
                            .pockets_y = 9,
                            .rib = 0.006};

template <typename Body>
std::string complaint(const Body& body) {
  try {
    if constexpr (std::is_same_v<Body, Plate>) {
      static_cast<void>(surface(body));
    } else {
      static_cast<void>(surface(body, 0.02));
    }
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

template <typename Body>
void expect_complaint(const Body& body, const std::string& words) {
  EXPECT_NE(complaint(body).find(words), std::string::npos)
      << "expected \"" << words << "\" in \"" << complaint(body) << "\"";
}

TEST(PlateSurface, IsABoxOfTwelveTriangles) {
  const Surface box = surface(Plate{0.6, 0.4, 0.02});
  EXPECT_EQ(box.points.rows(), 8);
  EXPECT_EQ(box.triangles.rows(), 12);
  expect_closed(box);
  EXPECT_NEAR(enclosed_volume(box), 0.6 * 0.4 * 0.02, 1e-16);
  EXPECT_EQ(box.patch_names,
            (std::vector<std::string>{"top", "bottom", "x_min", "x_max", "y_min", "y_max"}));
  EXPECT_NEAR(patch_area(box, "top"), 0.24, 1e-15);
  EXPECT_NEAR(patch_area(box, "x_min"), 0.008, 1e-15);
}

// The normal of every patch points out of the body along its axis.
TEST(PlateSurface, PatchesLookTheirWay) {
  const Surface box = surface(Plate{0.6, 0.4, 0.02});
  const std::vector<Eigen::Vector3d> outward{Eigen::Vector3d::UnitZ(),  -Eigen::Vector3d::UnitZ(),
                                             -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitX(),
                                             -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitY()};
  for (Eigen::Index t = 0; t < box.triangles.rows(); ++t) {
    const Eigen::Vector3d normal = area_vector(box.points, box.triangles, t).normalized();
    EXPECT_LT((normal - outward[static_cast<std::size_t>(box.patch(t))]).norm(), 1e-14);
  }
}

TEST(DiscSurface, HasTheAreaAndVolumeOfTheDisc) {
  for (const double hole : {0.0, 0.1}) {
    const Disc disc{.diameter = 0.3, .thickness = 0.01, .hole_diameter = hole};
    const Surface round = surface(disc, 0.02);
    expect_closed(round);
    const double area = kPi / 4.0 * (0.09 - hole * hole);
    EXPECT_NEAR(patch_area(round, "top"), area, 1e-13);
    EXPECT_NEAR(enclosed_volume(round), 0.01 * area, 1e-15);
    EXPECT_EQ(round.patch_names.size(), hole > 0.0 ? 4U : 3U);
  }
}

TEST(SphereSurface, NodesLieOnTheSphere) {
  const Surface ball = surface(Sphere{.diameter = 0.2}, 0.01);
  expect_closed(ball);
  for (const auto p : ball.points.rowwise()) EXPECT_NEAR(p.norm(), 0.1, 1e-15);
  EXPECT_NEAR(enclosed_volume(ball), kPi / 6.0 * 0.008, 2e-5);
}

TEST(TableSurface, IsTheBoundaryOfItsLayers) {
  WaferTable table = kReference;
  table.edge_cutout_length = 0.09;
  table.edge_cutout_depth = 0.03;
  table.corner_cutout = 0.04;
  for (const WaferTable& each : {kReference, table}) {
    const Surface outside = surface(each, 0.02);
    const Surface layers = as_surface(layered(each, 0.03, 2));
    expect_closed(outside);
    EXPECT_NEAR(enclosed_volume(outside), enclosed_volume(layers), 1e-15);
    EXPECT_EQ(outside.patch_names, layers.patch_names);
    for (const std::string& name : outside.patch_names) {
      EXPECT_NEAR(patch_area(outside, name), patch_area(layers, name), 1e-13) << name;
    }
  }
  EXPECT_NEAR(enclosed_volume(surface(kReference, 0.02)), 5752800e-9, 1e-14);
}

TEST(TableSurface, RimMayBeThickerThanTheRibs) {
  WaferTable table = kReference;
  table.rim = 0.012;
  const double pocket = (0.6 - 0.024 - 8 * 0.006) / 9;
  EXPECT_NEAR(enclosed_volume(surface(table, 0.02)), 0.36 * 0.05 - 81 * pocket * pocket * 0.042,
              1e-14);
}

TEST(TableSurface, RefusesPartsThatDoNotFit) {
  EXPECT_EQ(complaint(kReference), "");
  const auto with = [](auto change) {
    WaferTable table = kReference;
    change(table);
    return table;
  };
  expect_complaint(with([](auto& t) { t.rib = 0.08; }), "no room for 9 pockets along x");
  expect_complaint(with([](auto& t) { t.rib = -0.001; }), "rib is -0.001 m");
  expect_complaint(with([](auto& t) { t.rim = 0.3; }), "a rim of 0.3 m");
  expect_complaint(with([](auto& t) { t.face_sheet = 0.05; }), "face_sheet is 0.05 m");
  expect_complaint(with([](auto& t) { t.pockets_y = 0; }), "pockets are 9 by 0");
  expect_complaint(with([](auto& t) { t.pockets_x = -1; }), "pockets are -1 by 9");
  expect_complaint(with([](auto& t) { t.pockets_x = 2000000; }), "more than 1000 pockets");
  expect_complaint(with([](auto& t) { t.edge_cutout_length = 0.1; }), "expected both or neither");
  expect_complaint(with([](auto& t) { t.edge_cutout_length = 0.58, t.edge_cutout_depth = 0.02; }),
                   "edge_cutout_length is 0.58 m");
  expect_complaint(with([](auto& t) { t.corner_cutout = 0.3; }), "corner_cutout is 0.3 m");
  expect_complaint(with([](auto& t) { t.wafer_diameter = 0.3; }), "expected both or neither");
  expect_complaint(with([](auto& t) { t.wafer_diameter = 0.7, t.wafer_thickness = 0.001; }),
                   "wafer_diameter");
  expect_complaint(with([](auto& t) {
                     t.bores = {{{0.295, 0.0}, 0.02, 0.0}};
                   }),
                   "bore 1 at (0.295 m, 0 m) with diameter 0.02 m reaches outside");
  expect_complaint(with([](auto& t) { t.bores = {{{0.0, 0.0}, 0.02, 0.06}}; }), "depth is 0.06 m");
  expect_complaint(with([](auto& t) { t.bores = {{{0.0, 0.0}, 0.0, 0.0}}; }), "diameter is 0 m");
}

TEST(Surfaces, RefuseDimensionsThatAreNotPositive) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -0.02, kNaN, HUGE_VAL}) {
    expect_complaint(Plate{bad, 0.6, 0.02}, "plate: length is ");
    expect_complaint(Plate{0.6, 0.6, bad}, "plate: thickness is ");
    expect_complaint(Disc{.diameter = bad, .thickness = 0.02}, "disc: diameter is ");
    WaferTable table = kReference;
    table.height = bad;
    expect_complaint(table, "wafer table: height is ");
    expect_complaint(Sphere{.diameter = bad}, "sphere: diameter is ");
  }
  expect_complaint(Disc{.diameter = 0.3, .thickness = 0.02, .hole_diameter = 0.3},
                   "hole_diameter is 0.3 m, expected less than the diameter");
}

TEST(TableSurface, BoresTakeTheirCylinders) {
  WaferTable table{.length = 0.3, .width = 0.3, .height = 0.05};
  table.bores = {{{0.05, 0.02}, 0.02, 0.0}, {{-0.06, -0.07}, 0.03, 0.02}};
  const Surface bored = surface(table, 0.01);
  expect_closed(bored);
  const double through = kPi / 4.0 * 0.02 * 0.02 * 0.05;
  const double blind = kPi / 4.0 * 0.03 * 0.03 * 0.02;
  EXPECT_NEAR(enclosed_volume(bored), 0.3 * 0.3 * 0.05 - through - blind, 1e-12);
  EXPECT_NEAR(patch_area(bored, "top"), 0.09 - kPi / 4.0 * 0.02 * 0.02, 1e-11);
  EXPECT_NEAR(patch_area(bored, "bores"),
              kPi * 0.02 * 0.05 + kPi * 0.03 * 0.02 + kPi / 4.0 * 0.03 * 0.03, 2e-5);
}

TEST(TableSurface, ABoreThroughRibsKeepsTheTableWhole) {
  WaferTable table = kReference;
  table.bores = {{{0.033, 0.033}, 0.02, 0.0}};  // where two ribs cross
  const Surface bored = surface(table, 0.01);
  expect_closed(bored);
  EXPECT_LT(enclosed_volume(bored), enclosed_volume(surface(kReference, 0.01)));
}

TEST(TableSurface, AWaferIsARegionOfItsOwn) {
  WaferTable table{.length = 0.4, .width = 0.4, .height = 0.05};
  table.wafer_diameter = 0.3;
  table.wafer_thickness = 0.001;
  const Surface two = surface(table, 0.02);
  ASSERT_EQ(two.regions.size(), 2U);
  EXPECT_EQ(two.regions[0].name, "body");
  EXPECT_EQ(two.regions[1].name, "wafer");
  EXPECT_LT(two.regions[0].inside.z(), 0.0);
  EXPECT_GT(two.regions[1].inside.z(), 0.0);
  const double disc = kPi / 4.0 * 0.09;
  EXPECT_NEAR(patch_area(two, "wafer_top"), disc, 1e-10);
  EXPECT_NEAR(patch_area(two, "top"), 0.16 - disc, 1e-10);
  EXPECT_NEAR(patch_area(two, "interface_wafer"), disc, 1e-10);
}

// Tables showed places on it at -0.00 mm.
TEST(Layered, TopOfADiscIsAtZeroWithoutASign) {
  const auto disc = layered(Disc{.diameter = 0.3, .thickness = 0.01}, 0.1, 1);
  for (const double z : disc.points.col(2)) EXPECT_EQ(std::signbit(z), z != 0.0);
}

}  // namespace
}  // namespace chladni::mesh
