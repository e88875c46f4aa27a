// Uncertain bodies: each of them is one.
#include "stage/ensemble.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "mesh/bodies.h"
#include "solved_text.h"

namespace chladni::stage {
namespace {

const Solved& plate() {
  static const auto solved = solved_with(R"(title = "plate"
geometry = { plate = { length = "300 mm", width = "200 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 8, damping_ratio = 0.01 }
)");
  return solved;
}

// A thickness that varies by 45 % has draws without stiffness: three times the variation is lost.
TEST(Ensemble, HasOnlyBodiesWithAPositiveStiffness) {
  study::UncertaintyPlan plan;
  plan.thickness = 0.45;
  plan.members = 40;
  const auto members = ensemble(plate().solution, plan, 3);
  ASSERT_EQ(members.size(), 40U);
  for (const auto& one : members) {
    const auto& hz = one.frequency_hz;
    EXPECT_LT(hz.head(6).maxCoeff(), 1.0) << hz.transpose();
    EXPECT_GT(hz.tail(hz.size() - 6).minCoeff(), 10.0) << hz.transpose();
  }
}

TEST(Ensemble, IsTheSameForOneSeedAndTheBodyItselfWithoutDeviations) {
  study::UncertaintyPlan plan;
  plan.members = 2;
  const auto& nominal = plate().solution.modes.frequency_hz;
  const auto still = ensemble(plate().solution, plan, 1);
  const auto flexible = nominal.size() - 6;
  EXPECT_LT((still[1].frequency_hz.tail(flexible).array() / nominal.tail(flexible).array() - 1.0)
                .abs()
                .maxCoeff(),
            1e-9);
  plan.modulus = 0.05;
  EXPECT_EQ(ensemble(plate().solution, plan, 1)[1].frequency_hz,
            ensemble(plate().solution, plan, 1)[1].frequency_hz);
  EXPECT_NE(ensemble(plate().solution, plan, 1)[1].frequency_hz,
            ensemble(plate().solution, plan, 2)[1].frequency_hz);
}

// The mean of what the four masses add to the mass of the modes is that of an even coating, also
// where a part of the surface has most of the faces.
TEST(Ensemble, HasMassesWhereverTheSurfaceIs) {
  Solution solution = plate().solution;
  auto& body = solution.model.body;
  body = mesh::layered(mesh::Plate{.length = 0.3, .width = 0.2, .thickness = 0.01}, 0.01, 1);
  for (auto& x : body.points.col(0)) {  // four times as fine at one end
    const double t = 0.5 + x / 0.3;
    x = 0.3 * (0.4 * t + 0.6 * t * t) - 0.15;
  }
  auto& shapes = solution.modes.shapes;
  shapes = Eigen::Matrix3d::Identity().replicate(body.node_count(), 1);
  for (Eigen::Index n = 0; n < body.node_count(); ++n) shapes(3 * n + 2, 1) = body.points(n, 0);
  solution.modes.frequency_hz = Eigen::VectorXd::Zero(3);
  study::UncertaintyPlan plan;
  plan.attached_mass = 1e-3;
  plan.members = 4000;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& one : ensemble(solution, plan, 5)) {
    sum += (one.turn * one.turn.transpose()).inverse() - Eigen::Matrix3d::Identity();
  }
  // In units of all masses: the middle of their places along the plate.
  EXPECT_NEAR(sum(1, 2) / sum(2, 2), 0.0, 0.006);
}

}  // namespace
}  // namespace chladni::stage
