#include "modal/kalman_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <chrono>
#include <cmath>

#include "base/draw.h"
#include "dense/riccati.h"
#include "tests/modal/disturbed_chain.h"
#include "tests/refusal.h"

namespace chladni::modal {
namespace {

std::vector<Disturbance> all_courses() {
  return {white(0.3),
          {.name = "hum",
           .input = 0,
           .course = DisturbanceCourse::band,
           .rms = 0.5,
           .low_hz = 20.0,
           .high_hz = 300.0},
          {.name = "hose",
           .input = 1,
           .course = DisturbanceCourse::drift,
           .rms = 0.1,
           .drift_time_s = 0.5}};
}

Eigen::MatrixXd covariance(const Eigen::MatrixXd& values) {
  return values.transpose() * values / static_cast<double>(values.rows());
}

// Over the deviations of both sides.
double relative(const Eigen::MatrixXd& value, const Eigen::MatrixXd& expected) {
  const Eigen::VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (value - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

void expect_optimal(const KalmanFilter& filter, const Course& course, Eigen::Index from) {
  const auto found = estimate(filter, course.inputs, course.sensors);
  const auto samples = course.sensors.rows() - from;
  const Eigen::MatrixXd e = found.innovation.bottomRows(samples);
  const Eigen::MatrixXd wrong = (found.points - course.wanted).bottomRows(samples);
  const double spread = 6.0 / std::sqrt(static_cast<double>(samples));
  EXPECT_LT(relative(covariance(e), filter.innovation), spread);
  const Eigen::VectorXd scale = filter.innovation.diagonal().cwiseSqrt().cwiseInverse();
  for (const Eigen::Index lag : {1, 2, 3, 10, 50}) {
    const Eigen::MatrixXd lagged = e.bottomRows(samples - lag).transpose() *
                                   e.topRows(samples - lag) / static_cast<double>(samples - lag);
    EXPECT_LT((scale.asDiagonal() * lagged * scale.asDiagonal()).cwiseAbs().maxCoeff(), spread)
        << lag;
  }
  // Errors of the points follow each other, so that fewer of them are independent.
  EXPECT_LT(relative(covariance(wrong), filter.point_covariance), 8.0 * spread);
}

TEST(KalmanFilter, StatesTheErrorsThatItMakes) {
  for (const bool held : {true, false}) {
    auto model = continuous(held);
    model.input_delay(0) = 3.4 * kSampleTime;
    model.output_delay(1) = 1.7 * kSampleTime;
    const auto filter =
        kalman_filter(disturbed_model(model, 1, all_courses(), kSensorNoise, kSampleTime));
    EXPECT_LT(filter.pole.cwiseAbs().maxCoeff(), 1.0);
    expect_optimal(filter, simulated(filter.system, 200000, 5), 20000);
  }
}

// The structure with a quarter of the sample time: the noise holds for four of its steps, the
// sensor is three of them late. Nothing of the sampling with fractions is in it.
TEST(KalmanFilter, KnowsASensorThatIsAPartOfASampleLate) {
  auto model = continuous(true);
  model.output_delay(0) = 0.75 * kSampleTime;
  const auto filter =
      kalman_filter(disturbed_model(model, 1, {white(0.3)}, kSensorNoise, kSampleTime));
  const auto fine = discretised(continuous(true).space, 0.25 * kSampleTime);
  constexpr Eigen::Index kSamples = 100000;
  Draw draw(11);
  const auto force = noise(draw, kSamples, Eigen::Vector2d(1.0, 0.3));
  Course course{force.leftCols(1), noise(draw, kSamples, kSensorNoise),
                Eigen::MatrixXd(kSamples, 2)};
  Eigen::VectorXd x = Eigen::VectorXd::Zero(fine.a.rows());
  double late = 0.0;
  for (Eigen::Index k = 0; k < kSamples; ++k) {
    const Eigen::VectorXd u = force.row(k).transpose();
    const Eigen::VectorXd y = fine.c * x + fine.d * u;
    course.sensors(k, 0) += late;
    course.sensors(k, 1) += y(1);
    course.wanted.row(k) = y.tail(2).transpose();
    for (int step = 0; step < 4; ++step) {
      if (step == 1) late = (fine.c * x + fine.d * u)(0);  // a quarter of a sample after k
      x = (fine.a * x + fine.b * u).eval();
    }
  }
  expect_optimal(filter, course, 5000);
}

TEST(KalmanFilter, WithUnboundedNoiseAndAsManySensorsAsStatesIsTheStaticInverse) {
  Draw draw(8);
  DisturbedModel system;
  auto& space = system.model.space;
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(16);
  space.a = 0.5 * noise(draw, 4, ones.head(4));
  space.b = Eigen::MatrixXd::Identity(4, 4);
  space.c = noise(draw, 6, ones.head(4));  // four sensors, two points
  space.d = Eigen::MatrixXd::Zero(6, 4);
  space.sample_time_s = kSampleTime;
  system.model.states.resize(4);
  system.sensors = 4;
  system.noise_rms = Eigen::VectorXd::Constant(4, 1e4);
  system.sensor_rms = Eigen::VectorXd::Ones(4);
  const auto filter = kalman_filter(system);
  const Eigen::MatrixXd inverse = space.c.bottomRows(2) * space.c.topRows(4).inverse();
  EXPECT_LT((filter.point_gain - inverse).norm(), 1e-6 * inverse.norm());
  EXPECT_LT((filter.point_covariance - inverse * inverse.transpose()).norm(),
            1e-6 * inverse.squaredNorm());
}

// A body that is pushed by white force: position and velocity. The gains of position and
// velocity [α, β/T] satisfy β = 2 (2 − α) − 4 √(1 − α) and λ² = β² / (1 − α) with
// λ = σ_w T² / (m σ_v), for noise that is held between samples (Kalata 1984).
TEST(KalmanFilter, OfABodyUnderWhiteForceHasTheGainsOfTheTrackingIndex) {
  ReducedModel body;
  body.rigid_count = 1;
  body.frequency_hz = Eigen::VectorXd::Zero(1);
  body.damping_ratio = Eigen::VectorXd::Zero(1);
  body.output_shapes = Eigen::MatrixXd::Constant(2, 1, 1.0 / std::sqrt(2.0));  // 2 kg
  body.input_shapes = Eigen::MatrixXd::Constant(1, 1, 1.0 / std::sqrt(2.0));
  body.residual = Eigen::MatrixXd::Zero(2, 1);
  const auto model = control_model(body, {{"s"}, {"z"}}, {"f"});
  for (const double force : {1e-4, 0.1, 30.0}) {
    const double sensor = 4e-9;
    const auto filter =
        kalman_filter(disturbed_model(model, 0, {{.name = "f", .input = 0, .rms = force}},
                                      Eigen::VectorXd::Constant(1, sensor), kSampleTime));
    const double index = force / 2.0 * kSampleTime * kSampleTime / sensor;
    const double alpha = filter.point_gain(0, 0);
    const double beta = filter.gain(1, 0) / std::sqrt(2.0) * kSampleTime;
    EXPECT_NEAR(beta, 2.0 * (2.0 - alpha) - 4.0 * std::sqrt(1.0 - alpha), 1e-8 * beta + 1e-14);
    EXPECT_NEAR(index * index, beta * beta / (1.0 - alpha), 1e-7 * index * index);
    EXPECT_NEAR(filter.point_covariance(0, 0), alpha * sensor * sensor, 1e-7 * sensor * sensor);
  }
}

TEST(KalmanFilter, IsNeverWorseThanWithoutMeasurementsOrWithFewer) {
  const auto model = continuous(true);
  const auto both =
      kalman_filter(disturbed_model(model, 1, {white(0.3)}, kSensorNoise, kSampleTime));
  const auto& space = both.system.model.space;
  const Eigen::MatrixXd moved = both.system.noise_inputs();
  const Eigen::MatrixXd alone = dense::stationary_covariance(space.a, moved * moved.transpose());
  const Eigen::MatrixXd c = space.c.bottomRows(2);
  const Eigen::MatrixXd through = both.system.noise_through().bottomRows(2);
  const Eigen::MatrixXd without = c * alone * c.transpose() + through * through.transpose();
  const auto least = [](const Eigen::MatrixXd& m) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m).eigenvalues().minCoeff();
  };
  const auto deaf = kalman_filter(
      disturbed_model(model, 1, {white(0.3)}, Eigen::Vector2d(2e-9, 1.0), kSampleTime));
  EXPECT_GT(least(without - both.prediction_covariance), -1e-12 * without.norm());
  EXPECT_GT(least(both.prediction_covariance - both.point_covariance), -1e-12 * without.norm());
  EXPECT_GT(least(deaf.point_covariance - both.point_covariance), -1e-12 * without.norm());
  EXPECT_LT(both.point_covariance.trace(), 0.05 * without.trace());
}

TEST(KalmanFilter, IsAModelThatStepsByItself) {
  auto model = continuous(false);
  model.input_delay(0) = 2.3 * kSampleTime;
  model.output_delay(0) = 1.4 * kSampleTime;
  const auto filter =
      kalman_filter(disturbed_model(model, 1, all_courses(), kSensorNoise, kSampleTime));
  const auto course = simulated(filter.system, 300, 2);
  const auto expected = estimate(filter, course.inputs, course.sensors, true);
  const auto observer = observer_model(filter);
  check(observer);
  EXPECT_EQ(observer.outputs[0].name + " " + observer.outputs[3].name, "z1 s2_innovation");
  EXPECT_EQ(observer.inputs[2].name, "s2");
  Eigen::VectorXd x = Eigen::VectorXd::Zero(observer.space.a.rows());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(3);
  for (Eigen::Index k = 0; k < 300; ++k) {
    const auto then = k - static_cast<Eigen::Index>(observer.input_delay(0));
    u(0) = then < 0 ? 0.0 : course.inputs(then, 0);
    u.tail(2) = course.sensors.row(k).transpose();
    const Eigen::VectorXd out = observer.space.c * x + observer.space.d * u;
    EXPECT_LT((out.head(2) - expected.points.row(k).transpose()).norm(), 1e-15);
    EXPECT_LT((out.tail(2) - expected.innovation.row(k).transpose()).norm(), 1e-15);
    EXPECT_LT((x - expected.states.row(k).transpose()).norm(), 1e-9 * (1e-6 + x.norm()));
    x = (observer.space.a * x + observer.space.b * u).eval();
  }
}

TEST(KalmanFilter, NamesWhatNoSensorSeesOrNothingMoves) {
  auto model = continuous(false);
  model.space.c.topRows(2).leftCols(2).setZero();  // of the rigid-body mode
  const auto blind = disturbed_model(model, 1, {white(0.3)}, kSensorNoise, kSampleTime);
  EXPECT_EQ(unseen_states(blind), std::vector<std::string>{"mode_1_position"});
  EXPECT_NE(refusal_of([&] { return kalman_filter(blind); }).find("no sensor sees mode_1"),
            std::string::npos);
  model = continuous(false);
  model.space.b.row(1).setZero();
  const auto still = disturbed_model(model, 1, {white(0.3)}, kSensorNoise, kSampleTime);
  EXPECT_FALSE(undisturbed_states(still).empty());
  EXPECT_NE(refusal_of([&] { return kalman_filter(still); }).find("no disturbance moves mode_1"),
            std::string::npos);
  // A drift at a place that only moves what is seen already cannot be told from another there.
  const Disturbance drift{
      .name = "hose", .input = 1, .course = DisturbanceCourse::drift, .rms = 0.1};
  auto twin = drift;
  twin.name = "cable";
  const auto same =
      disturbed_model(continuous(false), 1, {drift, twin, white(0.1)}, kSensorNoise, kSampleTime);
  EXPECT_EQ(unseen_states(same).size(), 1U);
  // An undamped mode that no sensor sees is refused; a damped one decays by itself.
  auto undamped = continuous(true, 0.0);
  undamped.space.c.topRows(2).middleCols(4, 2).setZero();
  const auto hidden = disturbed_model(undamped, 1, {white(0.3)}, kSensorNoise, kSampleTime);
  ASSERT_EQ(unseen_states(hidden).size(), 1U);
  EXPECT_EQ(unseen_states(hidden)[0].substr(0, 6), "mode_3");
  auto damped = continuous(true);
  damped.space.c.topRows(2).middleCols(4, 2).setZero();
  EXPECT_TRUE(
      unseen_states(disturbed_model(damped, 1, {white(0.3)}, kSensorNoise, kSampleTime)).empty());
}

TEST(KalmanFilter, OfTwentyModesTakesLessThanATenthOfASecond) {
  const auto model = control_model(
      reduced(chain(40, false), 20, {0, 9, 22, 39, 15},
              {0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 33, 36}, 0.005),
      {{"s1"}, {"s2"}, {"s3"}, {"s4"}, {"z"}},
      {"a1", "a2", "a3", "a4", "a5", "a6", "a7", "a8", "a9", "a10", "a11", "a12", "a13"});
  std::vector<Disturbance> forces;
  for (Eigen::Index j = 0; j < 13; ++j) forces.push_back({.name = "f", .input = j, .rms = 0.1});
  const auto system =
      disturbed_model(model, 13, forces, Eigen::VectorXd::Constant(4, 1e-9), kSampleTime);
  double least = 1e9;  // other work on the machine takes time too
  for (int turn = 0; turn < 3; ++turn) {
    const auto begin = std::chrono::steady_clock::now();
    const auto filter = kalman_filter(system);
    least = std::min(
        least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    EXPECT_EQ(filter.gain.rows(), 40);
  }
  std::printf("Kalman filter of 40 states, 4 sensors: %.3f s\n", least);
}

}  // namespace
}  // namespace chladni::modal
