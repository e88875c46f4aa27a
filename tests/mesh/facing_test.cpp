// Which faces look one way: of bodies whose parts are known, turned any way.
#include "mesh/facing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/check.h"
#include "shapes.h"

namespace chladni::mesh {
namespace {

using shapes::box;
using shapes::prism;

TetMesh shell_of(const Surface& surface) {
  TetMesh shell;
  shell.points = surface.points;
  shell.faces = surface.triangles;
  shell.face_patch = surface.patch;
  shell.patch_names = surface.patch_names;
  shell.tets.resize(0, 4);
  return shell;
}

TetMesh turned(TetMesh body, const Eigen::Matrix3d& rotation) {
  body.points = (body.points * rotation.transpose()).eval();
  return body;
}

TetMesh ribbed() {
  return layered(WaferTable{.length = 0.3,
                            .width = 0.2,
                            .height = 0.03,
                            .face_sheet = 0.006,
                            .pockets_x = 3,
                            .pockets_y = 2,
                            .rib = 0.01},
                 Layering{.edge_length = 0.02});
}

TEST(Facing, OfAPlateIsEachOfItsSides) {
  const auto plate = layered(Plate{.length = 0.3, .width = 0.2, .thickness = 0.01}, 0.05, 1);
  const std::vector<std::pair<Eigen::Vector3d, std::string>> sides{
      {Eigen::Vector3d::UnitZ(), "top"},   {-Eigen::Vector3d::UnitZ(), "bottom"},
      {Eigen::Vector3d::UnitX(), "x_max"}, {-Eigen::Vector3d::UnitX(), "x_min"},
      {Eigen::Vector3d::UnitY(), "y_max"}, {-Eigen::Vector3d::UnitY(), "y_min"}};
  for (const auto& [direction, name] : sides) {
    const auto found = facing(plate, direction);
    for (Eigen::Index f = 0; f < plate.faces.rows(); ++f) {
      const auto& patch = plate.patch_names[static_cast<std::size_t>(plate.face_patch(f))];
      EXPECT_EQ(found.face[static_cast<std::size_t>(f)] != 0, patch == name) << name;
    }
    EXPECT_NEAR(found.area, found.silhouette, 1e-12) << name;
    EXPECT_EQ(found.parts, 1);
  }
}

// Seen from above a ribbed table is its face sheet; seen from below, ribs and pockets.
TEST(Facing, OfARibbedTableIsItsFaceSheetAndNotTheInsideOfItsPockets) {
  const auto table = ribbed();
  const auto up = facing(table, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(up.area, 0.06, 1e-12);
  for (Eigen::Index f = 0; f < table.faces.rows(); ++f) {
    if (up.face[static_cast<std::size_t>(f)] == 0) continue;
    EXPECT_EQ(table.patch_names[static_cast<std::size_t>(table.face_patch(f))], "top");
  }
  const auto down = facing(table, -Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(down.area, 0.06, 1e-12);
  EXPECT_EQ(down.parts, 7);  // the ribs, six pockets
}

TEST(Facing, DoesNotDependOnHowTheBodyLies) {
  const auto table = ribbed();
  const auto found = facing(table, Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized())).toRotationMatrix();
  const auto other = facing(turned(table, rotation), rotation.col(2));
  EXPECT_EQ(found.face, other.face);
  EXPECT_NEAR(found.silhouette, other.silhouette, 1e-9);
}

// The floor of a box with a slot from side to side lies under its lid.
TEST(Facing, LeavesOutWhatLiesUnderSomethingElse) {
  const auto slotted = shell_of(
      difference(box({0, 0, 0}, {0.3, 0.2, 0.05}), box({-0.1, 0.02, 0.01}, {0.4, 0.18, 0.04})));
  const auto found = facing(slotted, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(found.area, 0.06, 1e-9);
  for (std::size_t f = 0; f < found.face.size(); ++f) {
    if (found.face[f] == 0) continue;
    EXPECT_NEAR(slotted.points(slotted.faces(static_cast<Eigen::Index>(f), 0), 2), 0.05, 1e-9);
  }
}

// A shelf counts, the floor of a screw hole does not.
TEST(Facing, TakesStepsAndLeavesOutTheFloorsOfSmallHoles) {
  auto body = difference(box({0, 0, 0}, {0.3, 0.2, 0.03}), box({0.2, -0.1, 0.02}, {0.4, 0.3, 0.1}));
  body = difference(body, prism(0.1, 0.1, 0.003, 0.01, 0.1, 24));
  const auto found = facing(shell_of(body), Eigen::Vector3d::UnitZ());
  const double hole = 12.0 * 0.003 * 0.003 * std::sin(2.0 * std::numbers::pi / 24.0);
  EXPECT_NEAR(found.area, 0.06 - hole, 1e-9);
  EXPECT_NEAR(found.silhouette, 0.06, 1e-9);
  EXPECT_EQ(found.parts, 2);
  EXPECT_EQ(found.small_parts, 1);
}

// A cap of a ball: sin² 30° of its disc.
TEST(Facing, OfABallIsACap) {
  const auto ball = layered(Sphere{.diameter = 0.2}, 0.01);
  const auto found = facing(ball, Eigen::Vector3d(1, 1, 1).normalized());
  EXPECT_NEAR(found.area / found.silhouette, 0.25, 0.02);
  EXPECT_NEAR(found.silhouette, std::numbers::pi * 0.01, 0.02 * std::numbers::pi * 0.01);
}

TEST(Facing, RefusesADirectionThatIsNone) {
  const auto plate = layered(Plate{.length = 0.3, .width = 0.2, .thickness = 0.01}, 0.05, 1);
  EXPECT_THROW((void)facing(plate, Eigen::Vector3d(0, 0, 2)), InvalidInput);
}

}  // namespace
}  // namespace chladni::mesh
