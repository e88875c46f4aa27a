#include "modal/disturbed_model.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/draw.h"
#include "base/turn.h"
#include "dense/riccati.h"
#include "modal/kalman_filter.h"
#include "tests/modal/chain.h"
#include "tests/refusal.h"

namespace chladni::modal {
namespace {

constexpr double kSampleTime = 1e-4;

// Output = input: what a disturbance is can be seen at once.
ControlModel through() {
  ControlModel model;
  model.space = {Eigen::MatrixXd::Zero(0, 0), Eigen::MatrixXd::Zero(0, 1),
                 Eigen::MatrixXd::Zero(1, 0), Eigen::MatrixXd::Ones(1, 1), 0.0};
  model.inputs = {{"f", "N"}};
  model.outputs = {{"s", "N"}};
  model.input_delay.setZero(1);
  model.output_delay.setZero(1);
  return model;
}

DisturbedModel of(const Disturbance& one) {
  return disturbed_model(through(), 0, {one}, Eigen::VectorXd::Ones(1), kSampleTime);
}

// The variance of the output.
double variance(const DisturbedModel& system) {
  const Eigen::MatrixXd moved = system.noise_inputs();
  const Eigen::MatrixXd p =
      dense::stationary_covariance(system.model.space.a, moved * moved.transpose());
  double value = system.noise_through().squaredNorm();
  if (p.size() > 0) value += (system.model.space.c * p * system.model.space.c.transpose())(0);
  return value;
}

// One-sided power spectral density of the output [N²/Hz].
double density(const DisturbedModel& system, double frequency_hz) {
  return std::norm(response(system.model, frequency_hz)(0, 0)) * system.noise_rms.squaredNorm() *
         2.0 * kSampleTime;
}

TEST(DisturbedModel, HasTheStatedRms) {
  EXPECT_NEAR(variance(of({.name = "d", .rms = 0.3})), 0.09, 1e-12);
  for (const double low : {0.0, 10.0, 400.0}) {
    const auto band = of({.name = "d",
                          .course = DisturbanceCourse::band,
                          .rms = 0.3,
                          .low_hz = low,
                          .high_hz = 2500.0});
    EXPECT_NEAR(variance(band), 0.09, 1e-9) << low;
    EXPECT_EQ(band.state_count(), low > 0.0 ? 2 : 1);
  }
}

TEST(DisturbedModel, HasTheStatedDensity) {
  const auto flat = of({.name = "d", .density = 4e-6});
  EXPECT_NEAR(density(flat, 7.0), 4e-6, 1e-15);
  EXPECT_NEAR(variance(flat), 4e-6 * 5000.0, 1e-12);  // up to half of the sample rate
  const auto band = of({.name = "d",
                        .course = DisturbanceCourse::band,
                        .density = 4e-6,
                        .low_hz = 0.1,
                        .high_hz = 1000.0});
  EXPECT_NEAR(density(band, 10.0), 4e-6, 1e-3 * 4e-6);
  EXPECT_NEAR(density(band, 0.1), 2e-6, 1e-3 * 4e-6);
  EXPECT_LT(density(band, 4000.0), 0.15 * 4e-6);  // 1/17 and what folds back
}

// After n samples the covariance of x⁺ = A x + w from 0 is the sum of A^k Q A^kᵀ.
TEST(DisturbedModel, DriftsByTheStatedChange) {
  const auto drift =
      of({.name = "d", .course = DisturbanceCourse::drift, .rms = 0.2, .drift_time_s = 0.05});
  ASSERT_EQ(drift.state_count(), 1);
  EXPECT_EQ(drift.model.space.a(0, 0), 1.0);
  EXPECT_NEAR(500.0 * drift.noise_inputs().squaredNorm(), 0.04, 1e-12);
}

// Two sensors and a point under a force that is known.
ControlModel plant(double input_delay, double output_delay) {
  auto model = control_model(reduced(chain(20, true), 6, {0, 7, 12}, {2, 19}, 0.01),
                             {{"s1"}, {"s2"}, {"z"}}, {"a", "cable"});
  model.input_delay(0) = input_delay * kSampleTime;
  model.output_delay(1) = output_delay * kSampleTime;
  return model;
}

DisturbedModel sampled(const ControlModel& model, InputCourse course) {
  return disturbed_model(model, 1, {{.name = "cable", .input = 1, .rms = 0.3}},
                         Eigen::Vector2d(1e-9, 1e-9), kSampleTime, course);
}

// A measured force is that of the model at each sample; held, it is half a sample late.
TEST(DisturbedModel, LinearInputsAreNotLate) {
  const double hz = 200.0;
  const double late = 0.5 * kTwoPi * hz * kSampleTime;  // [rad]
  for (const double input_delay : {0.0, 0.3, 1.0, 2.6}) {
    for (const double output_delay : {0.0, 0.4, 1.0, 1.7}) {
      const auto model = plant(input_delay, output_delay);
      const Eigen::VectorXcd exact = response(model, hz).col(0);
      const auto error = [&](InputCourse course) -> Eigen::VectorXd {
        const Eigen::VectorXcd found = response(sampled(model, course).model, hz).col(0);
        return (found.array() / exact.array() - 1.0).abs();
      };
      const auto linear = error(InputCourse::linear);
      const auto held = error(InputCourse::held);
      for (Eigen::Index i = 0; i < 3; ++i) {
        EXPECT_LT(linear(i), 3e-3) << input_delay << " " << output_delay << " " << i;
        EXPECT_GT(held(i), 0.8 * late) << input_delay << " " << output_delay << " " << i;
      }
    }
  }
}

// Straight lines, in many held steps between two samples.
TEST(DisturbedModel, LinearInputsGoStraightFromSampleToSample) {
  constexpr Eigen::Index kSteps = 64;
  constexpr Eigen::Index kSamples = 60;
  Draw draw(3);
  Eigen::MatrixXd force(kSamples, 1);
  for (double& value : force.reshaped()) value = draw.normal();
  force(0) = 0.0;
  for (const double delay : {0.0, 0.25, 1.5}) {
    const auto model = plant(delay, 0.5);
    const auto coarse = sampled(model, InputCourse::linear);
    const auto fine = with_delay_states(discretised(model, kSampleTime / kSteps));
    KalmanFilter filter{coarse, {}, {}, {}, {}, {}, {}, {}};
    filter.gain.setZero(coarse.state_count(), 2);
    filter.point_gain.setZero(1, 2);
    const auto found = estimate(filter, force, Eigen::MatrixXd::Zero(kSamples, 2), true);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(fine.space.a.rows());
    double wrong = 0.0;
    double size = 0.0;
    for (Eigen::Index k = 0; k + 1 < kSamples; ++k) {
      const Eigen::Vector2d now(force(k), 0.0);
      const Eigen::VectorXd y = fine.space.c * x + fine.space.d * now;
      wrong += std::pow(found.points(k, 0) - y(2), 2);
      size += std::pow(found.points(k, 0), 2);
      const Eigen::VectorXd states = found.states.row(k).head(model.space.a.rows());
      EXPECT_LT((states - x.head(states.size())).norm(), 1e-3 * (x.norm() + 1e-6)) << k;
      for (Eigen::Index s = 0; s < kSteps; ++s) {
        const double part = (static_cast<double>(s) + 0.5) / kSteps;
        const Eigen::Vector2d u(force(k) + part * (force(k + 1) - force(k)), 0.0);
        x = (fine.space.a * x + fine.space.b * u).eval();
      }
    }
    EXPECT_LT(wrong, 1e-4 * size) << delay;
  }
}

TEST(DisturbedModel, RefusesWhatIsNoDisturbance) {
  const auto refused = [](const Disturbance& one) { return refusal_of([&] { return of(one); }); };
  EXPECT_NE(refused({.name = "d"}).find("disturbance \"d\": expected a positive rms"),
            std::string::npos);
  EXPECT_NE(refused({.name = "d", .rms = 1.0, .density = 1.0}).find("rms or a positive density"),
            std::string::npos);
  EXPECT_NE(refused({.name = "d", .input = 3, .rms = 1.0}).find("at no input"), std::string::npos);
  EXPECT_NE(refused({.name = "d",
                     .course = DisturbanceCourse::band,
                     .rms = 1.0,
                     .low_hz = 5.0,
                     .high_hz = 6000.0})
                .find("half of the sample rate, 5000 Hz"),
            std::string::npos);
  EXPECT_NE(
      refused({.name = "d", .course = DisturbanceCourse::drift, .density = 1.0}).find("a drift"),
      std::string::npos);
  EXPECT_NE(refusal_of([] {
              return disturbed_model(through(), 0, {{.name = "d", .rms = 1.0}},
                                     Eigen::VectorXd::Zero(1), kSampleTime);
            }).find("the noise of sensor \"s\" is 0"),
            std::string::npos);
  auto late = through();
  late.output_delay(0) = 1.0;
  EXPECT_NE(refusal_of([&] {
              return disturbed_model(late, 0, {{.name = "d", .rms = 1.0}}, Eigen::VectorXd::Ones(1),
                                     kSampleTime);
            }).find("10000 samples"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::modal
