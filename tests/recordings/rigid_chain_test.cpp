#include "recordings/rigid_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"

namespace chladni::recordings {
namespace {

// Eigenvalues are known to some 1e-16 of the largest, (1e5 Hz)².
constexpr double kRounding = 1e-7;
const Eigen::VectorXd kPlaces = (Eigen::VectorXd(5) << 0.05, 0.15, 0.25, 0.35, 0.45).finished();

RigidChain free_strip(Eigen::Index bodies) {
  RigidChain chain;
  chain.bodies = bodies;
  chain.sway_hz = 0.0;
  chain.turn_hz = 0.0;
  return chain;
}

// (βL)² of a free beam: cos βL cosh βL = 1.
double free_beam_hz(const RigidChain& strip, double beta_l2) {
  const double bending = strip.youngs_modulus * std::pow(strip.thickness_m, 2) / 12.0;
  return beta_l2 / (2.0 * std::numbers::pi * std::pow(strip.length_m, 2)) *
         std::sqrt(bending / strip.density);
}

double largest_difference(const modal::Frf& a, const modal::Frf& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.value.size(); ++k) {
    largest = std::max(largest, (a.value[k] - b.value[k]).norm() / b.value[k].norm());
  }
  return largest;
}

TEST(RigidChain, ConvergesToTheFreeBeamWithTheSquareOfTheBodysLength) {
  const Eigen::Vector3d beta_l2(22.37328545, 61.67282287, 120.90339);
  Eigen::Vector3d error[2];
  for (const int level : {0, 1}) {
    const auto strip = free_strip(level == 0 ? 20 : 40);
    const auto model = reduced_model(matrices(strip), kPlaces, kPlaces, 5);
    ASSERT_EQ(model.rigid_count, 2);
    for (int i = 0; i < 3; ++i) {
      error[level](i) = model.frequency_hz(i + 2) / free_beam_hz(strip, beta_l2(i)) - 1.0;
    }
  }
  // Rotary inertia takes (t/L)² of some tens: below 3e-4 on the third mode.
  EXPECT_LT(error[1].cwiseAbs().maxCoeff(), 4e-4);
  const double converged = 4.0 / 3.0;  // (e20 − e40) · 4/3 = what 20 bodies miss
  EXPECT_LT(std::abs((error[0] - error[1])(2)) * converged, 2e-3);
}

TEST(RigidChain, HangsOnFlexuresAsTheThesisBeamDoes) {
  const auto model = reduced_model(matrices(beam_with_coils()), kPlaces, kPlaces, 6);
  EXPECT_EQ(model.rigid_count, 0);
  EXPECT_NEAR(model.frequency_hz(0), 2.5, kRounding);
  EXPECT_NEAR(model.frequency_hz(1), 5.0, kRounding);
  EXPECT_NEAR(model.damping_ratio(0), 0.02, kRounding);
  EXPECT_NEAR(model.damping_ratio(1), 0.02, kRounding);
  EXPECT_NEAR(model.frequency_hz(2), 32.7, 0.01);
  EXPECT_NEAR(model.frequency_hz(3), 89.69, 0.01);
  EXPECT_NEAR(model.frequency_hz(4), 177.94, 0.01);
}

TEST(RigidChain, ACarriedBodyMakesTheModeThatNoStripHas) {
  const auto model = reduced_model(matrices(beam_with_carried_body()), kPlaces, kPlaces, 6);
  EXPECT_NEAR(model.frequency_hz(0), 2.5, kRounding);
  EXPECT_NEAR(model.frequency_hz(1), 5.0, kRounding);
  EXPECT_NEAR(model.frequency_hz(2), 32.7, 0.01);
  EXPECT_NEAR(model.frequency_hz(3), 51.9, 0.01);
  EXPECT_NEAR(model.frequency_hz(4), 93.6, 0.1);
}

// Joint dashpots in proportion to joint stiffness, and nothing else: the modes do not couple.
TEST(RigidChain, RespondsAsAllItsModesWhereDampingIsProportional) {
  const auto chain = matrices(free_strip(12));
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(40, 3.0, 400.0);
  const auto model = reduced_model(chain, kPlaces, kPlaces, 13);
  EXPECT_LT(largest_difference(frf(chain, kPlaces, kPlaces, f), modal::frf(model, f)), 1e-9);
}

TEST(RigidChain, ItsFlexuresCoupleTheModesALittle) {
  const auto chain = matrices(beam_with_coils());
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(60, 1.0, 200.0);
  const auto exact = frf(chain, kPlaces, kPlaces, f);
  const auto modes = modal::frf(reduced_model(chain, kPlaces, kPlaces, 51), f);
  const double difference = largest_difference(modes, exact);
  EXPECT_GT(difference, 1e-6);
  EXPECT_LT(difference, 2e-2);
  for (const auto& value : exact.value) {
    EXPECT_LT((value - value.transpose()).norm(), 1e-10 * value.norm());
  }
}

TEST(RigidChain, MovesAsItsMassFarBelowItsModes) {
  auto strip = free_strip(20);
  strip.masses = {{0.25, 0.1}};
  const double mass = 0.5 * 0.02 * 0.002 * 7850.0 + 0.1;
  const Eigen::VectorXd middle = Eigen::VectorXd::Constant(1, 0.25);
  const double f = 0.05;
  const auto response = frf(matrices(strip), middle, middle, Eigen::VectorXd::Constant(1, f));
  const double omega = 2.0 * std::numbers::pi * f;
  EXPECT_NEAR(response.value[0](0, 0).real() * -omega * omega * mass, 1.0, 1e-4);
}

TEST(RigidChain, KeepsTheFlexibilityOfTheModesItLeavesOut) {
  const auto chain = matrices(beam_with_coils());
  const Eigen::VectorXd f = Eigen::VectorXd::Constant(1, 1e-3);
  const auto exact = frf(chain, kPlaces, kPlaces, f);
  const auto reduced = modal::frf(reduced_model(chain, kPlaces, kPlaces, 4), f);
  EXPECT_LT(largest_difference(reduced, exact), 1e-4);
}

TEST(RigidChain, RefusesWhatIsNoBeam) {
  RigidChain chain;
  chain.bodies = 2;
  EXPECT_THROW((void)matrices(chain), InvalidInput);
  chain = {};
  chain.masses = {{0.6, 0.01}};
  EXPECT_THROW((void)matrices(chain), InvalidInput);
  chain = {};
  chain.turn_hz = 2.6;  // below √3 · 2.5 Hz or so the flexures would have to push
  EXPECT_THROW((void)matrices(chain), NumericalFailure);
  EXPECT_THROW((void)frf(matrices(free_strip(10)), kPlaces, kPlaces, Eigen::VectorXd::Zero(1)),
               InvalidInput);
}

}  // namespace
}  // namespace chladni::recordings
