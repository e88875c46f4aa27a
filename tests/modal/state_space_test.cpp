#include "modal/state_space.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "tests/modal/chain.h"

namespace chladni::modal {
namespace {

const std::vector<Eigen::Index> kOutputs{0, 7, 19};
const std::vector<Eigen::Index> kInputs{2, 19};

Chain damped_chain(bool held) {
  auto structure = chain(20, held);
  structure.dashpots = Eigen::MatrixXd::Zero(20, 2);
  structure.dashpots(3, 0) = std::sqrt(40.0);
  structure.dashpots(7, 1) = std::sqrt(300.0);
  structure.dashpots(12, 1) = -std::sqrt(300.0);
  return structure;
}

void expect_same_response(const ReducedModel& model, FrfKind kind) {
  const auto space = state_space(model, kind);
  const Eigen::VectorXd frequency_hz = Eigen::VectorXd::LinSpaced(60, 3.0, 4000.0);
  const auto expected = frf(model, frequency_hz, kind);
  for (std::size_t k = 0; k < 60; ++k) {
    const auto found = response(space, frequency_hz(static_cast<Eigen::Index>(k)));
    EXPECT_LT((found - expected.value[k]).norm(), 1e-10 * expected.value[k].norm());
  }
}

TEST(StateSpace, RespondsAsTheModesDo) {
  for (const bool held : {false, true}) {
    expect_same_response(reduced(chain(20, held), 8, kOutputs, kInputs, 0.01), FrfKind::receptance);
  }
}

TEST(StateSpace, RespondsAsTheModesDoWithDashpotsAndTheirResidualFlexibility) {
  for (const bool held : {false, true}) {
    const auto model = reduced(damped_chain(held), 8, kOutputs, kInputs, 0.01);
    EXPECT_EQ(state_space(model).a.rows(), 18);  // a state more for each dashpot
    expect_same_response(model, FrfKind::receptance);
  }
}

TEST(StateSpace, RespondsAsTheModesDoWithDashpotsAndNoModeLeftOut) {
  const auto model = reduced(damped_chain(false), 20, kOutputs, kInputs, 0.0);
  EXPECT_EQ(state_space(model).a.rows(), 40);
  expect_same_response(model, FrfKind::receptance);
}

TEST(StateSpace, GivesVelocitiesAndAccelerations) {
  auto model = reduced(damped_chain(false), 8, kOutputs, kInputs, 0.01);
  model.residual.setZero();  // has no place in a proper model of these
  model.dampers.to_outputs.setZero();
  model.dampers.from_inputs.setZero();
  expect_same_response(model, FrfKind::mobility);
  expect_same_response(model, FrfKind::accelerance);
}

TEST(StateSpace, IsStable) {
  const auto space = state_space(reduced(damped_chain(true), 8, kOutputs, kInputs, 0.01));
  const Eigen::VectorXcd poles = space.a.eigenvalues();
  EXPECT_LT(poles.real().maxCoeff(), 0.0);
  const auto sampled = discretised(space, 1e-4);
  EXPECT_LT(sampled.a.eigenvalues().cwiseAbs().maxCoeff(), 1.0);
}

ReducedModel single(double frequency_hz, double damping_ratio) {
  ReducedModel model;
  model.frequency_hz = Eigen::VectorXd::Constant(1, frequency_hz);
  model.damping_ratio = Eigen::VectorXd::Constant(1, damping_ratio);
  model.rigid_count = frequency_hz == 0.0 ? 1 : 0;
  model.output_shapes = model.input_shapes = Eigen::MatrixXd::Ones(1, 1);
  model.residual = Eigen::MatrixXd::Zero(1, 1);
  return model;
}

// 1 − e^{−ζωt} (cos ω_d t + ζω/ω_d sin ω_d t), over ω².
TEST(StateSpace, DiscretisedHasTheExactStepResponse) {
  const double omega = 2.0 * std::numbers::pi * 50.0;
  const double zeta = 0.05;
  const double turned = omega * std::sqrt(1.0 - zeta * zeta);
  const double sample = 3e-3;  // seven samples a period: far from small steps
  const auto model = discretised(state_space(single(50.0, zeta)), sample);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2);
  for (int k = 1; k <= 50; ++k) {
    x = model.a * x + model.b * Eigen::VectorXd::Ones(1);
    const double t = k * sample;
    const double expected =
        (1.0 - std::exp(-zeta * omega * t) *
                   (std::cos(turned * t) + zeta * omega / turned * std::sin(turned * t))) /
        (omega * omega);
    EXPECT_NEAR((model.c * x)(0), expected, 1e-13 / omega);
  }
}

TEST(StateSpace, ARigidBodyModeIsADoubleIntegrator) {
  const auto model = discretised(state_space(single(0.0, 0.0)), 0.01);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2);
  for (int k = 1; k <= 100; ++k) x = model.a * x + model.b * Eigen::VectorXd::Ones(1);
  EXPECT_NEAR((model.c * x)(0), 0.5, 1e-13);
}

TEST(StateSpace, DiscretisedTendsToTheContinuousResponse) {
  const auto space = state_space(reduced(damped_chain(true), 8, kOutputs, kInputs, 0.01));
  const auto continuous = response(space, 200.0);
  double before = 1.0;
  for (const double sample : {4e-5, 2e-5, 1e-5}) {
    // The hold delays what goes through the states by half a sample.
    const std::complex<double> delay =
        std::exp(std::complex<double>(0.0, 2.0 * std::numbers::pi * 200.0 * sample / 2.0));
    const auto sampled = response(discretised(space, sample), 200.0);
    const double error =
        (delay * (sampled - space.d) - (continuous - space.d)).norm() / continuous.norm();
    EXPECT_LT(error, 0.5 * before);
    before = error;
  }
}

TEST(StateSpace, RefusesWhatCannotBeMeant) {
  const auto space = state_space(single(50.0, 0.01));
  EXPECT_THROW((void)discretised(space, 0.0), InvalidInput);
  EXPECT_THROW((void)discretised(space, std::nan("")), InvalidInput);
  EXPECT_THROW((void)discretised(discretised(space, 1e-3), 1e-3), InvalidInput);
  EXPECT_THROW((void)response(space, -1.0), InvalidInput);
  auto bad = single(50.0, 0.01);
  bad.damping_ratio.resize(2);
  EXPECT_THROW((void)state_space(bad), InvalidInput);
}

}  // namespace
}  // namespace chladni::modal
