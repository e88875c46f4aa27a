#include "recordings/virtual_experiment.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "base/error.h"
#include "base/turn.h"
#include "modal/frf.h"
#include "modal/state_space.h"
#include "recordings/fft.h"
#include "tests/recordings/rigs.h"

namespace chladni::recordings {
namespace {

using Complex = std::complex<double>;

Eigen::MatrixXd measured_noise(Eigen::Index samples, Eigen::Index columns) {
  Draw draw(4);
  Eigen::MatrixXd result(samples, columns);
  for (double& x : result.reshaped()) x = draw.normal();
  return result;
}

// Against the dense discretisation of the whole state space, an independent path.
TEST(VirtualExperiment, MovesAsTheDiscretisedStateSpace) {
  auto model = two_modes();
  model.frequency_hz = Eigen::Vector2d(0.0, 47.0);
  model.rigid_count = 1;
  const auto rig = rig_of(model, 512.0);
  const auto space = modal::discretised(modal::state_space(model), rig.sample_time_s);
  const auto u = measured_noise(200, 2);
  Draw draw(1);
  const auto record = recorded(rig, u, draw);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(space.a.rows());
  for (Eigen::Index n = 0; n < u.rows(); ++n) {
    EXPECT_LT((record.outputs.row(n).transpose() - space.c * x).norm(), 1e-12) << n;
    x = (space.a * x + space.b * u.row(n).transpose()).eval();
  }
}

TEST(VirtualExperiment, DelaysByWholeSamplesAndByFractions) {
  auto rig = rig_of(two_modes(), 512.0);
  const auto u = measured_noise(200, 2);
  Draw draw(1);
  const auto prompt = recorded(rig, u, draw).outputs;
  rig.delay_s = 3.0 * rig.sample_time_s;
  const auto late = recorded(rig, u, draw).outputs;
  EXPECT_LT((late.bottomRows(197) - prompt.topRows(197)).norm(), 1e-12 * prompt.norm());
  // Half a sample: the same as whole samples at twice the rate.
  rig.delay_s = 0.5 * rig.sample_time_s;
  const auto half = recorded(rig, u, draw).outputs;
  auto fast = rig;
  fast.sample_time_s = 0.5 * rig.sample_time_s;
  Eigen::MatrixXd twice(400, 2);
  for (Eigen::Index n = 0; n < 400; ++n) twice.row(n) = u.row(n / 2);
  const auto fine = recorded(fast, twice, draw).outputs;
  for (Eigen::Index n = 0; n < 200; ++n) {
    EXPECT_LT((half.row(n) - fine.row(2 * n)).norm(), 1e-12) << n;
  }
}

TEST(VirtualExperiment, StepsGiveWhatTheWholeRecordGives) {
  auto model = two_modes();
  model.residual.setConstant(2e-5);
  auto rig = rig_of(model, 512.0);
  rig.delay_s = 1.3 * rig.sample_time_s;
  const auto u = measured_noise(100, 2);
  Draw draw(1);
  const auto whole = recorded(rig, u, draw).outputs;
  rig.controller = Controller{.a = Eigen::MatrixXd::Zero(1, 1),
                              .b = Eigen::MatrixXd::Zero(1, 2),
                              .c = Eigen::MatrixXd::Zero(1, 1),
                              .d = Eigen::MatrixXd::Zero(1, 2),
                              .controlled = {0}};
  const auto stepped = recorded(rig, u, draw);
  EXPECT_LT((stepped.outputs - whole).norm(), 1e-12 * whole.norm());
  EXPECT_EQ(stepped.inputs, u);
}

TEST(VirtualExperiment, ASpringOfNoStiffnessChangesNothing) {
  auto rig = rig_of(two_modes(), 512.0);
  const auto u = measured_noise(300, 2);
  Draw draw(1);
  // A delay ends between two of the eight parts of a sample, or within one.
  for (const double delay : {0.0, 0.125, 0.3, 1.01, 2.97}) {
    rig.delay_s = delay * rig.sample_time_s;
    rig.spring.reset();
    const auto linear = recorded(rig, u, draw).outputs;
    rig.spring = CubicSpring{.stiffness = 0.0, .output = 0, .input = 0};
    EXPECT_LT((recorded(rig, u, draw).outputs - linear).norm(), 1e-10 * linear.norm()) << delay;
  }
}

// Duffing's backbone: ω² = ω₀² + ¾ k a² / m; free vibration keeps its energy with the substeps'
// square.
TEST(VirtualExperiment, ACubicSpringIsFollowedToSecondOrder) {
  const auto model = model_of(Eigen::VectorXd::Constant(1, 20.0), 0.0, Eigen::MatrixXd::Ones(1, 1),
                              Eigen::MatrixXd::Ones(1, 1));
  auto rig = rig_of(model, 512.0);
  Eigen::MatrixXd kick = Eigen::MatrixXd::Zero(2048, 1);
  kick(0, 0) = 512.0 * 20.0;  // a velocity of 20 m/s
  const double omega = kTwoPi * 20.0;
  rig.spring = CubicSpring{.stiffness = 0.2 * omega * omega * omega * omega / 400.0};
  Draw draw(1);
  double error[2];
  rig.substeps = 64;
  const auto exact = recorded(rig, kick, draw).outputs;
  for (const int level : {0, 1}) {
    rig.substeps = level == 0 ? 4 : 8;
    error[level] = (recorded(rig, kick, draw).outputs - exact).norm() / exact.norm();
  }
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.6);
  // Half the energy law: ½v² = ½ω₀²a² + ¼ka⁴.
  const double k = rig.spring->stiffness;
  const double a2 =
      (std::sqrt(omega * omega * omega * omega + 2.0 * k * 400.0) - omega * omega) / k;
  EXPECT_NEAR(exact.cwiseAbs().maxCoeff(), std::sqrt(a2), 5e-3 * std::sqrt(a2));
}

// Largest difference of the blocks' response from (K + jωC − ω²M)⁻¹ up to 250 Hz.
double difference_of_chain(double highest_hz) {
  const auto chain = matrices(beam_with_coils());
  const Eigen::VectorXd at = Eigen::Vector3d(0.05, 0.15, 0.45);
  const auto found = plant(chain, at, at.head(1), highest_hz);
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(50, 1.0, 250.0);
  const auto exact = frf(chain, at, at.head(1), f);
  double largest = 0.0;
  for (Eigen::Index k = 0; k < f.size(); ++k) {
    const Complex s(0.0, kTwoPi * f(k));
    Eigen::MatrixXcd sum = found.d.cast<Complex>();
    for (const auto& block : found.blocks) {
      const auto n = block.a.rows();
      const Eigen::MatrixXcd pencil = s * Eigen::MatrixXcd::Identity(n, n) - block.a;
      sum += block.c * pencil.partialPivLu().solve(block.b.cast<Complex>());
    }
    const auto& want = exact.value[static_cast<std::size_t>(k)];
    largest = std::max(largest, (sum - want).norm() / want.norm());
  }
  return largest;
}

TEST(VirtualExperiment, TheChainInTimeIsTheChainInFrequency) {
  EXPECT_LT(difference_of_chain(1e9), 1e-7);
  // Modes above 1500 Hz as springs: what is missing is their damping, (f / 1500 Hz) of little.
  EXPECT_LT(difference_of_chain(1500.0), 2e-3);
}

// Two modes with residual flexibility, as large as the modes from about 25 Hz on.
modal::ReducedModel flexible_modes() {
  auto model = two_modes();
  model.residual << 5e-5, -1e-5, -2e-5, 8e-5;
  return model;
}

// The same with a dashpot, which has residual flexibility of its own in series.
modal::ReducedModel damped_modes() {
  auto model = flexible_modes();
  const double root = std::sqrt(3.0);  // of N s/m
  model.dampers.shapes = root * Eigen::RowVector2d(0.8, -0.4);
  model.dampers.to_outputs = root * Eigen::Vector2d(2e-8, -1e-8);
  model.dampers.from_inputs = root * Eigen::RowVector2d(1e-8, 3e-8);
  model.dampers.among = root * root * Eigen::MatrixXd::Constant(1, 1, 4e-8);
  return model;
}

// A rig that has a displacement, a velocity and an acceleration of each of two places.
VirtualRig rig_of_rates(modal::ReducedModel model, double sampling_hz) {
  model.output_shapes = model.output_shapes.replicate(3, 1).eval();
  model.residual = model.residual.replicate(3, 1).eval();
  const auto count = model.damper_count();
  model.dampers.to_outputs =
      count > 0 ? model.dampers.to_outputs.replicate(3, 1).eval() : Eigen::MatrixXd(6, 0);
  auto rig = rig_of(model, sampling_hz);
  std::vector<modal::FrfKind> kinds;
  for (const auto kind :
       {modal::FrfKind::receptance, modal::FrfKind::mobility, modal::FrfKind::accelerance}) {
    kinds.insert(kinds.end(), 2, kind);
  }
  rig.plant = plant(model, kinds);
  return rig;
}

// Largest difference of the velocities' and accelerations' steady response from jω and (jω)² times
// (G + R) of the first places, held and delayed, relative, up to `high_hz` of 512.
double difference_of_rates(const modal::ReducedModel& model, double delay_samples, double high_hz) {
  auto rig = rig_of_rates(model, 512.0);
  rig.delay_s = delay_samples * rig.sample_time_s;
  VirtualExperimentPlan plan = plan_of_seconds(1);
  plan.multisine.high_hz = high_hz;
  plan.warm_up = 8;
  const auto data = virtual_experiment(rig, plan, 1, 3);
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(std::lround(high_hz) - 4, 5.0, high_hz);
  const auto want = modal::frf(model, f);
  double largest = 0.0;
  for (Eigen::Index k = 0; k < f.size(); ++k) {
    const double omega = kTwoPi * f(k);
    const double x = 0.5 * omega * rig.sample_time_s;
    const Complex held = std::sin(x) / x * std::exp(Complex(0.0, -x - omega * rig.delay_s));
    for (std::size_t j = 0; j < 2; ++j) {
      const auto& record = data.records[j];
      const auto line = [&](const Eigen::VectorXd& samples) {
        return fourier(samples)(static_cast<Eigen::Index>(std::lround(f(k))));
      };
      const auto column = static_cast<Eigen::Index>(j);
      const Complex force = line(record.inputs.col(column));
      for (Eigen::Index i = 2; i < 6; ++i) {
        const Complex rate = i < 4 ? Complex(0.0, omega) : Complex(-omega * omega, 0.0);
        const auto& g = want.value[static_cast<std::size_t>(k)];
        const Complex expected = rate * held * g(i % 2, column) * force;
        const double scale = std::abs(rate * force) * g.col(column).norm();
        largest = std::max(largest, std::abs(line(record.outputs.col(i)) - expected) / scale);
      }
    }
  }
  return largest;
}

// (jω)ⁿ of the displacement, static flexibility included. It was left out; then what a sampled
// acceleration folds back, and a quarter of the sampling frequency, were off by several per cent.
TEST(VirtualExperiment, VelocitiesAndAccelerationsContainTheStaticFlexibility) {
  for (const double delay : {0.0, 0.3, 0.5, 1.7, 3.0}) {
    EXPECT_LT(difference_of_rates(flexible_modes(), delay, 128.0), 3e-4) << delay;
    EXPECT_LT(difference_of_rates(flexible_modes(), delay, 205.0), 1e-3) << delay;
  }
}

// A mode at rest yields as far below its frequency.
TEST(VirtualExperiment, ModesAtRestYieldStatically) {
  for (const auto& model : {flexible_modes(), damped_modes()}) {
    const auto at_rest = at_rest_above(model, 30.0);
    EXPECT_EQ(at_rest.mode_count(), 1);
    EXPECT_EQ(at_rest_above(model, 50.0).mode_count(), 2);
    const Eigen::VectorXd low = Eigen::VectorXd::Constant(1, 0.01);
    const Eigen::MatrixXcd want = modal::frf(model, low).value[0];
    EXPECT_LT((modal::frf(at_rest, low).value[0] - want).norm(), 1e-5 * want.norm());
  }
}

// A force reached the accelerations through the flexibility in series with a dashpot at once.
TEST(VirtualExperiment, VelocitiesAndAccelerationsAreDampedAsTheModel) {
  for (const double delay : {0.0, 0.3}) {
    EXPECT_LT(difference_of_rates(damped_modes(), delay, 128.0), 3e-4) << delay;
  }
}

TEST(VirtualExperiment, RatesInStepsAreThoseOfTheWholeRecord) {
  auto rig = rig_of_rates(flexible_modes(), 512.0);
  rig.delay_s = 1.3 * rig.sample_time_s;
  const auto u = measured_noise(100, 2);
  Draw draw(1);
  const auto whole = recorded(rig, u, draw).outputs;
  rig.spring = CubicSpring{.stiffness = 0.0, .output = 0, .input = 0};
  EXPECT_LT((recorded(rig, u, draw).outputs - whole).norm(), 1e-10 * whole.norm());
}

TEST(VirtualExperiment, ALoopOfVelocitiesIsRefused) {
  auto rig = rig_of_rates(flexible_modes(), 512.0);
  rig.delay_s = rig.sample_time_s;
  rig.controller = Controller{.a = Eigen::MatrixXd::Zero(1, 1),
                              .b = Eigen::MatrixXd::Zero(1, 6),
                              .c = Eigen::MatrixXd::Zero(1, 1),
                              .d = Eigen::MatrixXd::Zero(1, 6),
                              .controlled = {0}};
  EXPECT_THROW(check(rig), InvalidInput);
}

TEST(VirtualExperiment, NoiseAndQuantisationAreAsLargeAsStated) {
  auto rig = rig_of(two_modes(), 512.0);
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(20000, 2);
  rig.sensor_noise = Eigen::Vector2d(2e-9, 0.0);
  Draw draw(3);
  const auto noisy = recorded(rig, rest, draw).outputs;
  EXPECT_NEAR(noisy.col(0).norm() / std::sqrt(20000.0), 2e-9, 3e-11);
  EXPECT_EQ(noisy.col(1).norm(), 0.0);
  rig.quantisation = Eigen::Vector2d(1e-9, 1e-9);
  const auto coarse = recorded(rig, rest, draw).outputs;
  const Eigen::VectorXd steps = coarse.col(0) / 1e-9;
  EXPECT_LT((steps.array() - steps.array().round()).abs().maxCoeff(), 1e-6);
}

TEST(VirtualExperiment, AStabiliserHoldsAFreeBody) {
  Eigen::MatrixXd shapes(3, 3);  // two rigid-body modes and one at 90 Hz at three places
  shapes << 1.0, -1.2, 0.8, 1.0, 0.1, -0.9, 1.0, 1.3, 0.7;
  const auto model = model_of(Eigen::Vector3d(0.0, 0.0, 90.0), 0.02, shapes, shapes.transpose());
  auto rig = rig_of(model, 2048.0);
  rig.delay_s = 1.5 * rig.sample_time_s;
  rig.controller = stabiliser(model, 2, {0, 2}, 8.0, rig.sample_time_s);
  check(rig);
  EXPECT_LT(largest_eigenvalue(rig.plant, *rig.controller, rig.sample_time_s, rig.delay_s), 1.0);
  Eigen::MatrixXd push = Eigen::MatrixXd::Zero(16384, 3);
  push.topRows(2048).setOnes();
  Draw draw(1);
  const auto y = recorded(rig, push, draw).outputs;
  EXPECT_LT(y.bottomRows(100).cwiseAbs().maxCoeff(), 1e-3 * y.cwiseAbs().maxCoeff());
  rig.controller = stabiliser(model, 2, {0, 2}, 200.0, rig.sample_time_s);
  EXPECT_THROW(check(rig), InvalidInput);
  EXPECT_THROW((void)stabiliser(model, 2, {0}, 8.0, rig.sample_time_s), InvalidInput);
}

TEST(VirtualExperiment, TheSameSeedGivesTheSameBits) {
  auto rig = rig_of(two_modes(), 512.0);
  rig.sensor_noise = Eigen::Vector2d(1e-6, 1e-6);
  const auto plan = plan_of_seconds(2);
  const auto a = virtual_experiment(rig, plan, 2, 5);
  const auto b = virtual_experiment(rig, plan, 2, 5);
  const auto c = virtual_experiment(rig, plan, 2, 6);
  ASSERT_EQ(a.records.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(a.records[i].outputs, b.records[i].outputs);
    EXPECT_NE(a.records[i].outputs, c.records[i].outputs);
  }
  check(a);
}

TEST(VirtualExperiment, RefusesWhatCannotBe) {
  auto rig = rig_of(two_modes(), 512.0);
  rig.delay_s = -1.0;
  EXPECT_THROW(check(rig), InvalidInput);
  rig = rig_of(two_modes(), 512.0);
  rig.sensor_noise = Eigen::Vector3d::Ones();
  EXPECT_THROW(check(rig), InvalidInput);
  rig = rig_of(two_modes(), 512.0);
  rig.controller = Controller{};
  EXPECT_THROW(check(rig), InvalidInput);  // no delay
}

}  // namespace
}  // namespace chladni::recordings
