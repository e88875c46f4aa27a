// Rigid-body motions of a body whose principal axes are hardly determined.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"
#include "tests/fem/field_on_plate.h"

namespace chladni::fem {
namespace {

// A square plate has two equal moments of inertia. A small mass on a diagonal makes them differ and
// turns the principal axes by 45 degrees.
TEST(RigidBody, MotionsAreOrthonormalHoweverNearlyMomentsAreEqual) {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.2, 0.2, 0.01}, 0.05, 1), 2);
  for (int power = -12; power <= -1; ++power) {
    const PointMass mass{.mass = std::pow(10.0, power)};
    const auto system = assemble(body, {isotropic(70e9, 0.33, 2700.0)}, {},
                                 {{"clamp", site_on(body, 0.08, 0.08), 0.0, mass}});
    ASSERT_EQ(system.rigid.cols(), 6);
    const Eigen::MatrixXd gram =
        system.rigid.transpose() * (system.mass.selfadjointView<Eigen::Lower>() * system.rigid);
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-12)
        << "mass 1e" << power << " kg";
  }
  const auto system = assemble(body, {isotropic(70e9, 0.33, 2700.0)}, {},
                               {{"clamp", site_on(body, 0.08, 0.08), 0.0, PointMass{1e-7}}});
  EXPECT_EQ(modes(system, {.count = 2}).modes.rigid_count, 6);
}

// Where supports hold one direction everywhere, as in a plane, no motion along it is left.
TEST(RigidBody, MotionsOfAPlateThatIsHeldToAPlaneAreThree) {
  const auto body = mesh::layered(mesh::Plate{0.2, 0.15, 0.01}, 0.05, 1);
  const Support top{.patch = "top", .z = true};
  const Support bottom{.patch = "bottom", .z = true};
  const auto system = assemble(body, {isotropic(70e9, 0.33, 2700.0)}, {top, bottom}, {});
  ASSERT_EQ(system.rigid.cols(), 3);
  const Eigen::MatrixXd gram =
      system.rigid.transpose() * (system.mass.selfadjointView<Eigen::Lower>() * system.rigid);
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(3, 3)).cwiseAbs().maxCoeff(), 1e-12);
  const auto found = modes(system, {.count = 4});
  EXPECT_EQ(found.modes.rigid_count, 3);
  EXPECT_TRUE(found.summary.complete);
  EXPECT_GT(found.modes.frequency_hz(3), 1000.0);
}

// Only the motion along z is left of one that is held along x and y.
TEST(RigidBody, MotionOfAPlateThatSlidesAlongZIsOne) {
  const auto body = mesh::layered(mesh::Plate{0.2, 0.15, 0.01}, 0.05, 1);
  const Support top{.patch = "top", .x = true, .y = true};
  const Support bottom{.patch = "bottom", .x = true, .y = true};
  const auto system = assemble(body, {isotropic(70e9, 0.33, 2700.0)}, {top, bottom}, {});
  ASSERT_EQ(system.rigid.cols(), 1);
  EXPECT_EQ(modes(system, {.count = 2}).modes.rigid_count, 1);
}

TEST(RigidBody, ABodyThatIsHeldEverywhereIsRefused) {
  const auto body = mesh::layered(mesh::Plate{0.2, 0.15, 0.01}, 0.05, 1);
  std::vector<Support> supports;
  for (const auto* patch : {"top", "bottom"}) {
    supports.push_back({.patch = patch, .x = true, .y = true, .z = true});
  }
  EXPECT_THROW((void)assemble(body, {isotropic(70e9, 0.33, 2700.0)}, supports, {}), InvalidInput);
}

// A pad of rubber that stands first in a study says nothing of the steel plate above it.
TEST(RigidBody, TheFrequencyScaleIsThatOfAllMaterials) {
  auto body = mesh::layered(mesh::Plate{0.2, 0.15, 0.01}, 0.05, 1);
  const auto steel = isotropic(210e9, 0.3, 7850.0);
  const auto rubber = isotropic(1e6, 0.3, 1100.0);
  const double alone = assemble(body, {steel}, {}, {}).frequency_scale_hz;
  body.region_names = {"pad", "plate"};
  body.region.setOnes();
  body.region(0) = 0;
  for (const bool turned : {false, true}) {
    if (turned) body.region = (1 - body.region.array()).matrix();
    const std::vector<Material> materials =
        turned ? std::vector{steel, rubber} : std::vector{rubber, steel};
    EXPECT_NEAR(assemble(body, materials, {}, {}).frequency_scale_hz, alone, 0.1 * alone);
  }
  body.region.setZero();  // both the same
  const std::vector<Material> same{steel, steel};
  EXPECT_NEAR(assemble(body, same, {}, {}).frequency_scale_hz, alone, 1e-9 * alone);
}

}  // namespace
}  // namespace chladni::fem
