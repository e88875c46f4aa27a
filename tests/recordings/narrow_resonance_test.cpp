// Variances from neighbouring lines, where a resonance is far narrower than their number.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "base/draw.h"
#include "recordings/estimate/line_variance.h"
#include "recordings/frf_estimate.h"

namespace chladni::recordings {
namespace {

constexpr Eigen::Index kLines = 61;
constexpr double kResonance = 30.3;  // [lines]

// One mode whose half-power bandwidth is `width` lines, 1 at its peak.
std::complex<double> narrow_response(Eigen::Index k, double width) {
  const double off = (static_cast<double>(k) - kResonance) / (0.5 * width);
  return 1.0 / std::complex<double>(1.0, off);
}

// Deviation of the noise of one period: of the sensor, and of a force that nobody measures.
struct NarrowNoise {
  double sensor, force;
  [[nodiscard]] double variance(Eigen::Index k, double width) const {
    return sensor * sensor + force * force * std::norm(narrow_response(k, width));
  }
};

Spectra narrow_record(double width, const NarrowNoise& noise, int periods, unsigned seed) {
  Draw draw(seed);
  Spectra made;
  made.outputs.resize(1);
  made.inputs.resize(1);
  made.outputs[0].name = "y";
  made.inputs[0].name = "u";
  made.sample_time_s = 1e-3;
  made.period = 1000;
  Spectra::Record one;
  for (Eigen::Index k = 0; k < kLines; ++k) made.line.push_back(100 + k);
  for (int p = 0; p < periods; ++p) {
    Eigen::MatrixXcd y(kLines, 1);
    for (Eigen::Index k = 0; k < kLines; ++k) {
      const double deviation = std::sqrt(0.5 * noise.variance(k, width));
      const double real = draw.normal();
      y(k, 0) = narrow_response(k, width) + deviation * std::complex<double>(real, draw.normal());
    }
    one.outputs.push_back(y);
    one.inputs.emplace_back(Eigen::MatrixXcd::Ones(kLines, 1));
    one.references.emplace_back(kLines, 0);
  }
  made.records.push_back(one);
  return made;
}

// Means over many records of the stated variance over the true one, on each line, and of its
// inverse, as weights have it.
struct NarrowRatios {
  Eigen::VectorXd stated, inverse;
};

NarrowRatios stated_over_true(double width, const NarrowNoise& noise, int periods) {
  constexpr unsigned kDraws = 200;
  FrfEstimateOptions options;
  options.drop = 0;
  NarrowRatios ratio{Eigen::VectorXd::Zero(kLines), Eigen::VectorXd::Zero(kLines)};
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const auto set = frf_estimate(narrow_record(width, noise, periods, seed), options).set;
    for (Eigen::Index k = 0; k < kLines; ++k) {
      const double one =
          periods * set.variance[static_cast<std::size_t>(k)](0, 0) / noise.variance(k, width);
      ratio.stated(k) += one / kDraws;
      ratio.inverse(k) += 1.0 / one / kDraws;
    }
  }
  return ratio;
}

// Two periods are averaged over 11 lines, four over 5. The inverse of a plain mean is 1.1 in the
// mean, and 1.2 at the ends of the band, where there are half as many lines.
TEST(NarrowResonance, DoesNotBlowUpVariancesOfASensorsNoise) {
  for (const int periods : {2, 4}) {
    const auto ratio = stated_over_true(1.0, {1e-3, 0.0}, periods);
    EXPECT_NEAR(ratio.stated.minCoeff(), 1.0, 0.15) << periods;
    EXPECT_NEAR(ratio.stated.maxCoeff(), 1.0, 0.15) << periods;
    EXPECT_GT(ratio.inverse.minCoeff(), 0.9) << periods;
    EXPECT_LT(ratio.inverse.maxCoeff(), 1.3) << periods;
  }
}

// The mean over 11 lines was 11 times too large beside the resonance, and on it a fifth. One shape
// that is beyond chance, else the mean: 0.4 of the true variance on it, and 5 times the weight.
TEST(NarrowResonance, DoesNotSpreadTheNoiseThatItMakesOfAForce) {
  for (const double width : {1.0, 2.0, 3.0}) {
    for (const int periods : {2, 4}) {
      const auto ratio = stated_over_true(width, {1e-3, 0.05}, periods);
      EXPECT_GT(ratio.stated.minCoeff(), 0.6) << width << " " << periods;
      EXPECT_LT(ratio.stated.maxCoeff(), 1.4) << width << " " << periods;
      EXPECT_LT(ratio.inverse.maxCoeff(), 2.3) << width << " " << periods;
    }
  }
}

// In the middle one line spreads evenly to both sides; a constant stays one, at the ends too.
TEST(AveragedVariances, AreMeansOverBothSidesWhereTheResponseIsOfOneSize) {
  const std::vector<Eigen::MatrixXcd> value(9, Eigen::MatrixXcd::Ones(1, 1));
  std::vector<Eigen::MatrixXd> one_line(9, Eigen::MatrixXd::Zero(1, 1));
  one_line[4](0, 0) = 5.0;
  const auto spread = averaged_variances(one_line, value, 2, 4.0);
  for (std::size_t k = 0; k < spread.size(); ++k) {
    EXPECT_DOUBLE_EQ(spread[k](0, 0), k >= 2 && k <= 6 ? 1.0 : 0.0) << k;
  }
  const std::vector<Eigen::MatrixXd> constant(9, Eigen::MatrixXd::Constant(1, 1, 3.0));
  for (const auto& one : averaged_variances(constant, value, 2, 4.0)) {
    EXPECT_DOUBLE_EQ(one(0, 0), 3.0);
  }
}

// In proportion to the power they are those of noise in proportion to it; nothing is nothing.
TEST(AveragedVariances, FollowTheResponseWhereTheNoiseDoes) {
  const Eigen::VectorXd power{{1.0, 1.2, 0.9, 90.0, 1.1}};
  for (Eigen::Index k = 0; k < power.size(); ++k) {
    EXPECT_NEAR(averaged_variance(0.01 * power, power, k, 8.0) / (0.01 * power(k)), 1.0, 0.1) << k;
    EXPECT_NEAR(averaged_variance(Eigen::VectorXd::Constant(5, 0.3), power, k, 8.0), 0.3, 1e-3);
    EXPECT_EQ(averaged_variance(Eigen::VectorXd::Zero(5), power, k, 8.0), 0.0);
  }
}

}  // namespace
}  // namespace chladni::recordings
