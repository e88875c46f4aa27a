// What noise leaves of a fit where variances are estimates, and what is known where data tell
// nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fit_errors.h"
#include "identification/fit_data.h"
#include "identification/identified.h"
#include "identification/modal_fit.h"
#include "identification/trust.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"
#include "tests/identification/gains/gain_case.h"

namespace chladni::identification {
namespace {

using simulators::FrfCase;
using simulators::FrfFaults;

FrfCase small_beam(unsigned seed) {
  FrfFaults faults;
  faults.seed = seed;
  return part(simulators::beam5x3(faults), {0, 4}, {0, 1});
}

// χ² of 2ν over 2ν: a sample variance of ν complex numbers over the true one.
double sample_variance(simulators::Dice& dice, int freedom) {
  double product = 1.0;  // sums of exponentials
  for (int i = 0; i < freedom; ++i) product *= dice.uniform();
  return -std::log(product) / freedom;
}

// Variances replaced by what `freedom` averages in all would say of them, each the mean of the
// estimates of `shared` lines.
void estimate_variances(FrfCase& made, int freedom, int shared, unsigned seed) {
  simulators::Dice dice(9000 + seed);
  auto& set = made.measured;
  const auto lines = static_cast<int>(set.variance.size());
  const int half = shared / 2;
  for (Eigen::Index e = 0; e < set.variance.front().size(); ++e) {
    std::vector<double> raw;
    for (int k = 0; k < lines + 2 * half; ++k) {
      raw.push_back(sample_variance(dice, freedom / shared));
    }
    for (int k = 0; k < lines; ++k) {
      double mean = 0.0;
      for (int i = 0; i < shared; ++i) mean += raw[static_cast<std::size_t>(k + i)] / shared;
      set.variance[static_cast<std::size_t>(k)].reshaped()(e) *= mean;
    }
  }
  set.averages = freedom;
}

struct Moments {
  double mean = 0.0, square = 0.0;
  int count = 0;
  void add(double z) {
    mean += z;
    square += z * z;
    ++count;
  }
  [[nodiscard]] double average() const { return mean / count; }
  [[nodiscard]] double deviation() const {
    return std::sqrt(square / count - average() * average());
  }
};

// A perfect model: its cost is above what noise leaves by a number of mean 0 and variance 1.
void expect_standard_normal(int freedom, int shared, double room) {
  constexpr unsigned kSeeds = 120;
  Moments excess;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    auto made = small_beam(seed);
    estimate_variances(made, freedom, shared, seed);
    const auto data = fit_data(made.measured);
    EXPECT_TRUE(data.noise_known);
    EXPECT_EQ(data.noise_freedom, freedom);
    excess.add(modal_fit(data, start_at(made.truth)).excess());
  }
  const double root = std::sqrt(static_cast<double>(kSeeds));
  EXPECT_LT(std::abs(excess.average()), 4.0 / root) << freedom << " " << shared;
  EXPECT_NEAR(excess.deviation(), 1.0, 4.0 / (std::sqrt(2.0) * root) + room)
      << freedom << " " << shared;
}

TEST(NoiseLevel, ExcessIsStandardNormalWithSampleVariances) {
  for (const int freedom : {8, 15, 50}) expect_standard_normal(freedom, 1, 0.0);
}

// Means over neighbours err together; how many there are is an estimate.
TEST(NoiseLevel, ExcessIsStandardNormalWithVariancesThatLinesShare) {
  expect_standard_normal(14, 7, 0.15);
  expect_standard_normal(33, 11, 0.15);
}

TEST(NoiseLevel, ExcessIsStandardNormalWithExactVariances) {
  Moments excess;
  for (unsigned seed = 1; seed <= 120; ++seed) {
    const auto made = small_beam(seed);
    excess.add(modal_fit(fit_data(made.measured), start_at(made.truth)).excess());
  }
  EXPECT_LT(std::abs(excess.average()), 4.0 / std::sqrt(120.0));
  EXPECT_NEAR(excess.deviation(), 1.0, 4.0 / std::sqrt(240.0));
}

TEST(NoiseLevel, KnowsHowManyLinesShareAVariance) {
  for (const auto& [freedom, shared] : {std::pair(15, 1), std::pair(14, 7), std::pair(33, 11)}) {
    auto made = simulators::beam5x3();
    estimate_variances(made, freedom, shared, 3);
    EXPECT_NEAR(fit_data(made.measured).shared_lines / shared, 1.0, 0.2) << shared;
  }
  auto constant = simulators::beam5x3();
  for (auto& line : constant.measured.variance) line = constant.measured.variance[0];
  constant.measured.averages = 20.0;
  EXPECT_EQ(fit_data(constant.measured).shared_lines, 799.0);
}

// Errors over stated deviations are standard normal, though the weights scatter.
TEST(NoiseLevel, DeviationsKnowThatTheWeightsScatter) {
  for (const int freedom : {5, 8, 50}) {
    double square = 0.0;
    double count = 0.0;
    for (unsigned seed = 1; seed <= 120; ++seed) {
      auto made = small_beam(seed);
      estimate_variances(made, freedom, 1, seed);
      const auto errors =
          fit_errors(made.truth, modal_fit(fit_data(made.measured), start_at(made.truth)));
      ASSERT_EQ(errors.missed, 0);
      square += (errors.frequency_hz.array() / errors.frequency_std_hz.array()).square().sum() +
                (errors.damping.array() / errors.damping_std.array()).square().sum();
      count += 2.0 * static_cast<double>(errors.damping.size());
    }
    EXPECT_NEAR(std::sqrt(square / count), 1.0, 4.0 / std::sqrt(2.0 * count)) << freedom;
  }
}

// What sample variances leave is no error of the model where nobody says that they are samples.
TEST(NoiseLevel, VariancesOfUnknownAveragesAreNotTakenForExact) {
  auto made = simulators::beam5x3();
  estimate_variances(made, 14, 7, 2);
  made.measured.averages = 0.0;
  const auto data = fit_data(made.measured);
  EXPECT_TRUE(data.noise_known);
  EXPECT_FALSE(data.freedom_known);
  Identified found;
  found.fit = modal_fit(data, start_at(made.truth));
  EXPECT_GT(found.fit.excess(), 5.0);
  const auto judgement = judged(found, data, std::nullopt);
  EXPECT_EQ(judgement.trust, Trust::good);
  EXPECT_NEAR(judgement.level, 14.0 / 13.0, 0.03);
  EXPECT_TRUE(judgement.outlying.empty());
  // More than the fewest averages leave is the model's.
  for (auto& line : made.measured.variance) line /= 1.6;
  const auto more = fit_data(made.measured);
  found.fit = modal_fit(more, start_at(made.truth));
  EXPECT_EQ(judged(found, more, std::nullopt).trust, Trust::systematic);
}

// 1/s² has no mean square: such variances are proportions.
TEST(NoiseLevel, VariancesOfTwoDegreesOfFreedomAreNotTaken) {
  auto made = small_beam(1);
  for (const double freedom : {1.0, 2.0}) {
    made.measured.averages = freedom;
    const auto data = fit_data(made.measured);
    EXPECT_FALSE(data.noise_known);
    EXPECT_TRUE(data.noise_stated);
  }
}

// One level, known or not: never below that of noise where it is known.
TEST(NoiseLevel, HasAFloorWhereTheNoiseIsKnown) {
  const auto made = small_beam(1);
  auto data = fit_data(made.measured);
  const auto expected = expected_cost(data, 40);
  EXPECT_DOUBLE_EQ(expected.mean, 0.5 * static_cast<double>(data.measured_count() - 40));
  EXPECT_DOUBLE_EQ(noise_level(data, 0.3 * expected.mean, 40), 1.0);
  EXPECT_DOUBLE_EQ(noise_level(data, 7.0 * expected.mean, 40), 7.0);
  data.noise_known = false;
  EXPECT_DOUBLE_EQ(noise_level(data, 0.3 * expected.mean, 40), 0.3);
  EXPECT_GT(noise_level(data, 0.0, 40), 0.0);
}

// A mode above the band without damping: no line is near it, so its damping alone is not known.
ModalFit undamped_above(Damping damping, FrfCase& made) {
  FrfFaults faults;
  faults.out_of_band = 0.2;
  faults.relative_noise = 1e-3;
  made = part(simulators::beam5x3(faults), {0, 1, 4}, {0, 2});
  auto truth = made.truth;
  const auto last = truth.mode_count() - 1;
  truth.damping_ratio(last) = 0.0;  // less than there is, as far as the data go
  auto data = fit_data(made.measured);
  truth.damping_ratio(last) = 1e-12;
  const auto start = start_at(truth);
  // The record of the same structure with that mode undamped.
  ModalFit exact;
  exact.model = truth;
  exact.model.damping_ratio(last) = -1e-3;  // and beyond: the bound has to hold it
  data.value += responses(exact, data.frequency_hz);
  exact.model.damping_ratio = made.truth.damping_ratio;
  data.value -= responses(exact, data.frequency_hz);
  FitOptions options;
  options.damping = damping;
  return modal_fit(data, start, options);
}

TEST(NoiseLevel, AnUndampedModeAboveTheBandTakesNoOtherDeviation) {
  for (const auto damping : {Damping::modal, Damping::general}) {
    FrfCase made;
    const auto fit = undamped_above(damping, made);
    const auto last = fit.model.mode_count() - 1;
    EXPECT_GT(fit.model.frequency_hz(last), 200.0);
    EXPECT_GT(fit.model.damping_ratio(last), 0.0);
    EXPECT_LT(fit.model.damping_ratio(last), 1e-6);
    EXPECT_TRUE(std::isinf(fit.damping_std(last)));
    EXPECT_TRUE(fit.frequency_std_hz.allFinite());
    EXPECT_TRUE(fit.damping_std.head(last).allFinite());
    EXPECT_TRUE(fit.output_std.allFinite());
    EXPECT_TRUE(fit.input_std.allFinite());
    EXPECT_GT(fit.output_std.minCoeff(), 0.0);
    const bool told = std::any_of(fit.notes.begin(), fit.notes.end(), [](const std::string& note) {
      return note.find("no damping") != std::string::npos;
    });
    EXPECT_TRUE(told);
    // What the data say of that damping without the bound: enough for a band of the responses.
    const auto& covariance = fit.mode_covariance[static_cast<std::size_t>(last)];
    EXPECT_TRUE(covariance.allFinite());
    EXPECT_GT(covariance(1, 1), 0.0);
    EXPECT_LT(covariance(1, 1), 1.0);
    // The others are as sure as they are with that mode given.
    const auto bounds = simulators::cramer_rao(made);
    EXPECT_LT((fit.frequency_std_hz.head(last).array() / bounds.frequency_hz.head(last).array())
                  .maxCoeff(),
              3.0);
  }
}

// A channel that was not measured takes no other channel's deviation, and has none of its own.
TEST(NoiseLevel, AnUnmeasuredChannelStaysUnknownThroughTheGains) {
  const auto whole = simulators::beam5x5();
  auto made = whole;
  for (auto& line : made.measured.value) line.row(2).setConstant(std::nan(""));
  const auto fit = modal_fit(fit_data(made.measured), start_at(made.truth));
  const auto match = matched(made, fit, with_pairs(made));
  const auto without = part(whole, {0, 1, 3, 4}, {0, 1, 2, 3, 4});
  const auto other = matched(without, modal_fit(fit_data(without.measured), start_at(made.truth)),
                             with_pairs(without));
  const std::vector<Eigen::Index> kept{0, 1, 3, 4};
  for (Eigen::Index m = 0; m < fit.model.mode_count(); ++m) {
    EXPECT_TRUE(std::isinf(match.deviation(2, m))) << m;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(match.deviation(kept[i], m) / other.deviation(row, m), 1.0, 1e-3)
          << m << " " << i;
    }
  }
  EXPECT_TRUE(match.input_deviation.allFinite());
}

}  // namespace
}  // namespace chladni::identification
