#include "modal/learned_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "modal/kalman_filter.h"
#include "tests/modal/disturbed_chain.h"
#include "tests/refusal.h"

namespace chladni::modal {
namespace {

constexpr Eigen::Index kSettled = 4000;

DisturbedModel chain_under(double force, double sensor_factor, double stiffer = 1.0) {
  auto model = reduced(chain(20, true), 6, {0, 7, 12, 19}, {2, 19}, 0.01);
  model.frequency_hz *= std::sqrt(stiffer);
  return disturbed_model(control_model(model, {{"s1"}, {"s2"}, {"z1"}, {"z2"}}, {"a1", "cable"}), 1,
                         {white(force)}, sensor_factor * kSensorNoise, kSampleTime);
}

RecordedSamples recorded(const Course& course) { return {course.inputs, course.sensors}; }

TEST(LearnedNoise, IsThatOfTheRecordings) {
  const auto stated = chain_under(0.3, 1.0);
  const auto course = simulated(chain_under(0.9, 0.5), 40000, 3);
  const auto found = learned_noise(stated, {{recorded(course)}}, kSettled);
  EXPECT_NEAR(found.disturbances, 3.0, 0.1);
  EXPECT_NEAR(found.sensors, 0.5, 0.02);
  EXPECT_GT(found.gain, 1000.0);
  EXPECT_FALSE(found.at_end);
}

// Twice the gain is χ² of two numbers where nothing is to be learned.
TEST(LearnedNoise, IsTheStatedOneWhereItIsTrue) {
  const auto stated = chain_under(0.3, 1.0);
  const auto found = learned_noise(
      stated, {{recorded(simulated(stated, 30000, 4)), recorded(simulated(stated, 20000, 5))}},
      kSettled);
  EXPECT_NEAR(found.disturbances, 1.0, 0.03);
  EXPECT_NEAR(found.sensors, 1.0, 0.03);
  EXPECT_GE(found.gain, -1e-6);
  EXPECT_LT(found.gain, 8.0);
}

TEST(LearnedNoise, GrowsWithTheRecordings) {
  const auto stated = chain_under(0.3, 1.0);
  auto samples = recorded(simulated(chain_under(0.6, 2.0), 12000, 6));
  const auto once = learned_noise(stated, {{samples}}, kSettled);
  samples.inputs *= 7.0;
  samples.outputs *= 7.0;
  const auto more = learned_noise(stated, {{samples}}, kSettled);
  EXPECT_NEAR(more.disturbances, 7.0 * once.disturbances, 1e-5 * more.disturbances);
  EXPECT_NEAR(more.sensors, 7.0 * once.sensors, 1e-5 * more.sensors);
}

// No factors nearby are likelier: by innovations of filters that are made anew.
TEST(LearnedNoise, IsLikelierThanItsNeighbours) {
  const auto stated = chain_under(0.3, 1.0);
  const auto samples = recorded(simulated(chain_under(0.5, 3.0), 12000, 7));
  const auto best = learned_noise(stated, {{samples}}, kSettled);
  const auto misfit = [&](double disturbances, double sensors) {
    const auto filter = kalman_filter(
        with_noise(stated, {best.disturbances * disturbances, best.sensors * sensors}));
    const Eigen::MatrixXd e = estimate(filter, samples.inputs, samples.outputs)
                                  .innovation.bottomRows(samples.outputs.rows() - kSettled);
    const Eigen::MatrixXd inverse = filter.innovation.inverse();
    return (e * inverse).cwiseProduct(e).sum() +
           static_cast<double>(e.rows()) * std::log(filter.innovation.determinant());
  };
  const double least = misfit(1.0, 1.0);
  for (const double a : {0.9, 1.0, 1.1}) {
    for (const double b : {0.9, 1.0, 1.1}) EXPECT_GE(misfit(a, b), least - 1e-6 * std::abs(least));
  }
}

// Part of the samples at which each point is within 1.96 stated deviations.
double covered(const KalmanFilter& filter, const Course& course) {
  const auto settled = course.sensors.rows() - kSettled;
  const Eigen::MatrixXd wrong =
      (estimate(filter, course.inputs, course.sensors).points - course.wanted).bottomRows(settled);
  const Eigen::RowVectorXd limit = 1.96 * filter.point_covariance.diagonal().cwiseSqrt();
  return (wrong.array().abs() <= limit.replicate(settled, 1).array()).cast<double>().mean();
}

TEST(LearnedNoise, MakesTheBandOfAModelThatErrsHold) {
  const auto stated = chain_under(0.02, 1.0, 1.02);
  const auto course = simulated(chain_under(0.02, 1.0), 40000, 8);
  const auto plain = kalman_filter(stated);
  const auto factors = learned_noise(stated, {{recorded(course)}}, kSettled);
  const auto learned = kalman_filter(with_noise(stated, factors));
  EXPECT_GT(factors.disturbances, 1.5);
  EXPECT_LT(covered(plain, course), 0.8);
  EXPECT_GT(covered(learned, course), 0.85);
}

// The deviation of a mean square is sqrt(2 / independent samples); errors of a lightly damped chain
// follow each other over some hundred samples.
TEST(LeftOutErrors, AreAsStatedWhereTheModelIsTrue) {
  const auto stated = chain_under(0.3, 1.0);
  const auto errors =
      left_out_errors(stated, {{recorded(simulated(stated, 200000, 10))}}, kSettled);
  ASSERT_EQ(errors.size(), 2);
  for (const double error : errors) EXPECT_NEAR(error, 1.0, 0.1);
}

TEST(LeftOutErrors, AreMoreWhereTheModelErrs) {
  const auto course = simulated(chain_under(0.02, 1.0), 40000, 8);
  const auto wrong = chain_under(0.02, 1.0, 1.02);
  EXPECT_GT(left_out_errors(wrong, {{recorded(course)}}, kSettled).minCoeff(), 2.0);
}

// Without its only sensor a free chain drifts unseen.
TEST(LeftOutErrors, AreUnknownWhereTheOtherSensorsLeaveAStateUnseen) {
  const auto model = control_model(reduced(chain(5, false), 3, {0, 4}, {1, 2}, 0.01),
                                   {{"s"}, {"z"}}, {"a", "cable"});
  const auto system =
      disturbed_model(model, 1, {white(0.3)}, Eigen::VectorXd::Constant(1, 1e-9), kSampleTime);
  const auto errors =
      left_out_errors(system, {{{Eigen::MatrixXd::Zero(50, 1), Eigen::MatrixXd::Zero(50, 1)}}}, 10);
  EXPECT_TRUE(std::isnan(errors(0)));
}

TEST(LearnedNoise, RefusesRecordsInWhichNothingSettles) {
  const auto stated = chain_under(0.3, 1.0);
  const auto samples = recorded(simulated(stated, 100, 9));
  EXPECT_NE(refusal_of([&] {
              return learned_noise(stated, {{samples}}, 100);
            }).find("no record is longer"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::modal
