// What a fit leaves beyond noise, line by line.
#include "identification/model_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulators/portable_random.h"

namespace chladni::identification {
namespace {

using Eigen::Index;

constexpr Index kLines = 400;
constexpr double kNoise = 1e-3;  // of |G|, which is 1

Eigen::MatrixXcd model() { return Eigen::MatrixXcd::Constant(kLines, 6, {0.6, -0.8}); }

// Off by 1 % in phase at the upper half of the lines.
FitData measured() {
  simulators::Dice dice(11);
  FitData data;
  data.outputs = 2;
  data.inputs = 3;
  data.frequency_hz = Eigen::VectorXd::LinSpaced(kLines, 1.0, 400.0);
  data.value = model();
  data.value.bottomRows(kLines / 2) *= std::complex<double>(1.0, 0.01);
  Eigen::MatrixXcd noise(kLines, 6);
  noise.real() = dice.normal(kLines, 6);
  noise.imag() = dice.normal(kLines, 6);
  data.value += kNoise * std::sqrt(0.5) * noise;
  data.weight = Eigen::MatrixXd::Constant(kLines, 6, 1.0 / kNoise);
  return data;
}

TEST(ModelError, IsWhatIsLeftBeyondNoiseWhereItIsLeft) {
  const auto error = remaining_model_error(measured(), model(), 0.1);
  ASSERT_EQ(error.size(), kLines);
  // Noise alone leaves up to some 0.3 of its own size where a line has 150 numbers.
  EXPECT_LT(error.head(180).maxCoeff(), 0.6 * kNoise);
  EXPECT_LT((error.tail(180).array() - 0.01).abs().maxCoeff(), 5e-4);
}

TEST(ModelError, IsNoMoreThanWasStated) {
  EXPECT_EQ(remaining_model_error(measured(), model(), 0.004).tail(180).minCoeff(), 0.004);
  EXPECT_EQ(remaining_model_error(measured(), model(), 0.0).maxCoeff(), 0.0);
}

TEST(ModelError, LowersTheWeightsToWhatIsExpected) {
  const auto noise_only = measured();
  const auto error = remaining_model_error(noise_only, model(), 0.1);
  const auto data = with_model_error(noise_only, model(), error);
  const Eigen::ArrayXXd left = data.weight.array() * (data.value - model()).cwiseAbs().array();
  // Beside the step, which the error takes 12 lines to follow.
  EXPECT_NEAR(left.topRows(180).square().mean(), 1.0, 0.08);
  EXPECT_NEAR(left.bottomRows(180).square().mean(), 1.0, 0.03);
  EXPECT_FALSE(data.noise_known);
  const auto same = with_model_error(noise_only, model(), Eigen::VectorXd::Zero(kLines));
  EXPECT_EQ(same.weight, noise_only.weight);
  EXPECT_TRUE(same.noise_known);
}

TEST(ModelError, LeavesOutWhatWasNotMeasured) {
  auto data = measured();
  data.value.col(2).setZero();
  data.weight.col(2).setZero();
  data.value.row(250).setConstant(7.0);
  data.weight.row(250).setZero();
  const auto error = remaining_model_error(data, model(), 0.1);
  EXPECT_LT((error.tail(180).array() - 0.01).abs().maxCoeff(), 5e-4);
  EXPECT_EQ(with_model_error(data, model(), error).weight.col(2).maxCoeff(), 0.0);
}

}  // namespace
}  // namespace chladni::identification
