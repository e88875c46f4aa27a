// Rigid-body motions of a body whose principal axes are hardly determined.
#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace chladni::fem
