#include "identification/validation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "base/draw.h"

namespace chladni::identification {
namespace {

using Eigen::Index;
using Complex = std::complex<double>;

const Eigen::Vector3d kResonances(100.0, 200.0, 300.0);

// Three resonances of two outputs and two inputs on 600 lines.
Eigen::MatrixXcd resonances(const Eigen::VectorXd& line_hz, Index modes) {
  Eigen::MatrixXcd value = Eigen::MatrixXcd::Zero(line_hz.size(), 4);
  const Eigen::Matrix<double, 2, 3> shapes{{1.0, 0.8, -0.5}, {0.6, -1.0, 0.9}};
  for (Index m = 0; m < modes; ++m) {
    for (Index k = 0; k < line_hz.size(); ++k) {
      const double w = line_hz(k) / kResonances(m);
      const Complex pole = 1.0 / Complex(1.0 - w * w, 0.02 * w);
      for (Index c = 0; c < 4; ++c) value(k, c) += shapes(c % 2, m) * shapes(c / 2, m) * pole;
    }
  }
  return value;
}

FitData noisy_data(double deviation, unsigned seed) {
  FitData data;
  data.outputs = data.inputs = 2;
  data.frequency_hz = Eigen::VectorXd::LinSpaced(600, 50.0, 350.0);
  data.value = resonances(data.frequency_hz, 3);
  data.weight = Eigen::MatrixXd::Constant(600, 4, 1.0 / deviation);
  Draw draw(seed);
  for (auto& value : data.value.reshaped()) {
    value += deviation * std::numbers::sqrt2 / 2.0 * Complex(draw.normal(), draw.normal());
  }
  return data;
}

TEST(Validation, LeavesNoiseOfATrueModel) {
  const auto data = noisy_data(0.05, 1);
  const auto result = validation(data, resonances(data.frequency_hz, 3), kResonances);
  ASSERT_EQ(result.bands.size(), 3U);
  for (const auto& band : result.bands) {
    EXPECT_NEAR(band.level, 1.0, 4.0 * band.level_deviation);
    EXPECT_LT(std::abs(band.correlation), 2.0 * band.correlation_limit);
  }
  EXPECT_NEAR(result.whole.level_deviation, 1.0 / std::sqrt(2400.0), 1e-12);
  EXPECT_GT(result.fit_percent, 95.0);
}

TEST(Validation, HasEveryLineInOneBand) {
  const auto data = noisy_data(0.05, 2);
  const auto fitted = resonances(data.frequency_hz, 3);
  Eigen::VectorXd crowded(5);
  crowded << 100.0, 199.9, 200.0, 200.1, 300.0;  // fewer than eight lines between three of them
  const auto bands = validation(data, fitted, crowded).bands;
  Index lines = 0;
  double power = 0.0;
  for (const auto& band : bands) {
    lines += band.lines;
    power += band.level * 4.0 * static_cast<double>(band.lines);
  }
  EXPECT_EQ(bands.size(), 3U);
  EXPECT_EQ(lines, 600);
  EXPECT_NEAR(power, 2400.0 * validation(data, fitted, crowded).whole.level, 1e-9 * power);
  EXPECT_EQ(validation(data, fitted, Eigen::VectorXd(0)).bands.size(), 1U);
}

// The band of a mode that the model lacks has a large residual, which neighbouring lines share.
TEST(Validation, NamesTheBandOfAMissingMode) {
  const auto data = noisy_data(0.05, 3);
  const auto bands = validation(data, resonances(data.frequency_hz, 2), kResonances).bands;
  ASSERT_EQ(bands.size(), 3U);
  EXPECT_LE(bands[2].low_hz, 300.0);
  EXPECT_GE(bands[2].high_hz, 300.0);
  EXPECT_GT(bands[2].level, 10.0 * bands[0].level);
  EXPECT_GT(bands[2].correlation, 0.8);
  EXPECT_GT(bands[2].correlation, 5.0 * bands[2].correlation_limit);
}

TEST(Validation, FitIsAHundredOfTheDataAndNothingOfTheirMean) {
  auto data = noisy_data(0.05, 4);
  EXPECT_EQ(validation(data, data.value, kResonances).fit_percent, 100.0);
  Eigen::MatrixXcd mean = data.value;
  for (Index c = 0; c < 4; ++c) mean.col(c).setConstant(data.value.col(c).mean());
  const auto result = validation(data, mean, kResonances);
  EXPECT_NEAR(result.fit_percent, 0.0, 1e-9);
  EXPECT_LT(result.fit_percent_of.cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Validation, WhatWasNotMeasuredDoesNotCount) {
  auto data = noisy_data(0.05, 5);
  data.weight.col(2).setZero();
  data.value.col(2).setZero();
  const auto result = validation(data, resonances(data.frequency_hz, 3), kResonances);
  EXPECT_TRUE(std::isnan(result.fit_percent_of(0, 1)));
  EXPECT_NEAR(result.whole.level, 1.0, 4.0 * result.whole.level_deviation);
  EXPECT_TRUE(mode_indicator(data).array().isNaN().all());
}

// Sample variances of ν degrees of freedom make |n|²/s² larger than 1 in the mean.
TEST(Validation, AllowsForSampleVariances) {
  auto data = noisy_data(0.05, 6);
  data.noise_freedom = 6.0;
  Draw draw(7);
  for (auto& weight : data.weight.reshaped()) {
    double square = 0.0;
    for (int n = 0; n < 12; ++n) square += std::pow(draw.normal(), 2) / 12.0;
    weight = 1.0 / (0.05 * std::sqrt(square));
  }
  const auto result = validation(data, resonances(data.frequency_hz, 3), kResonances);
  EXPECT_NEAR(result.whole.level, 1.0, 4.0 * result.whole.level_deviation);
}

// One variance of more lines than a band has errs on the lines of the band alone.
TEST(Validation, ABandSharesNoMoreLinesThanItHas) {
  auto data = noisy_data(0.05, 6);
  data.noise_freedom = 6.0;
  const auto fitted = resonances(data.frequency_hz, 3);
  data.shared_lines = static_cast<double>(data.line_count());
  const auto all = validation(data, fitted, kResonances);
  ASSERT_GT(all.bands.size(), 1U);
  for (std::size_t b = 0; b < all.bands.size(); ++b) {
    data.shared_lines = static_cast<double>(all.bands[b].lines);
    const auto own = validation(data, fitted, kResonances).bands[b];
    EXPECT_DOUBLE_EQ(all.bands[b].level_deviation, own.level_deviation) << b;
  }
}

TEST(ModeIndicator, HasTheSingularValuesOfEachLine) {
  const auto data = noisy_data(0.05, 8);
  const auto values = mode_indicator(data);
  ASSERT_EQ(values.rows(), 600);
  ASSERT_EQ(values.cols(), 2);
  for (const Index k : {0, 137, 599}) {
    EXPECT_GE(values(k, 0), values(k, 1));
    EXPECT_NEAR(values.row(k).squaredNorm(), data.value.row(k).squaredNorm(), 1e-12);
    const Complex determinant =
        data.value(k, 0) * data.value(k, 3) - data.value(k, 1) * data.value(k, 2);
    EXPECT_NEAR(values.row(k).prod(), std::abs(determinant), 1e-12);
  }
}

}  // namespace
}  // namespace chladni::identification
