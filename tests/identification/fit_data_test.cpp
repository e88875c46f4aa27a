#include "identification/fit_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfFaults;

const std::complex<double> kMissing(std::numeric_limits<double>::quiet_NaN(), 0.0);

modal::FrfSet beam(double floor) {
  FrfFaults faults;
  faults.relative_noise = 0.0;
  faults.floor_noise = floor;
  return simulators::beam5x3(faults).measured;
}

TEST(FitData, WeighsByTheStatedDeviation) {
  const auto set = simulators::beam5x3().measured;
  const auto data = fit_data(set);
  EXPECT_TRUE(data.noise_known);
  for (const Eigen::Index k : {0, 100, 798}) {
    const auto& variance = set.variance[static_cast<std::size_t>(k)];
    EXPECT_NEAR(data.weight(k, 2 + 5 * 1) * std::sqrt(variance(2, 1)), 1.0, 1e-12);
    EXPECT_EQ(data.value(k, 2 + 5 * 1), set.value[static_cast<std::size_t>(k)](2, 1));
  }
}

// A variance of 0 beside others is none, and a value of 0 with it was not measured.
TEST(FitData, TakesAVarianceOfNothingFromTheNeighbours) {
  auto set = simulators::beam5x3().measured;
  const auto full = fit_data(set);
  for (const std::size_t k : {100U, 101U, 300U}) set.variance[k](2, 1) = 0.0;
  set.variance[200](2, 1) = 0.0;
  set.value[200](2, 1) = 0.0;
  const auto data = fit_data(set);
  const Eigen::Index column = 2 + 5 * 1;
  for (const Eigen::Index k : {100, 101, 300}) {
    EXPECT_NEAR(std::log(data.weight(k, column) / full.weight(k, column)), 0.0, 1.0) << k;
  }
  EXPECT_EQ(data.weight(200, column), 0.0);
  EXPECT_EQ(data.weight(400, column), full.weight(400, column));
}

// White noise that is not stated is found, gaps or not.
TEST(FitData, EstimatesNoiseThatIsNotStatedAroundGaps) {
  auto set = beam(3.0);
  const double truth = std::sqrt(set.variance[0](0, 0));
  set.variance.clear();
  for (const std::size_t step : {1000, 3, 2}) {
    auto gaps = set;
    for (std::size_t k = 1; k < gaps.value.size(); k += step) gaps.value[k](1, 1) = kMissing;
    const auto data = fit_data(gaps);
    EXPECT_FALSE(data.noise_known);
    std::vector<double> found;
    const auto weight = data.weight.col(1 + 5);
    for (Eigen::Index k = 300; k < weight.size(); ++k) {  // above the steep part
      if (weight(k) > 0.0) found.push_back(1.0 / (weight(k) * truth));
    }
    std::nth_element(found.begin(), found.begin() + static_cast<long>(found.size() / 2),
                     found.end());
    EXPECT_NEAR(found[found.size() / 2], 1.0, 0.15) << step;
    EXPECT_LT(*std::max_element(found.begin(), found.end()), 3.0) << step;
  }
}

TEST(FitData, GivesNoWeightToWhatIsMissing) {
  auto set = beam(0.3);
  set.value[10](0, 0) = kMissing;
  for (auto& line : set.value) line(4, 2) = kMissing;
  const auto data = fit_data(set);
  EXPECT_EQ(data.weight(10, 0), 0.0);
  EXPECT_EQ(data.value(10, 0), std::complex<double>(0.0));
  EXPECT_GT(data.weight(11, 0), 0.0);
  EXPECT_EQ(data.weight.col(4 + 5 * 2).norm(), 0.0);
  EXPECT_EQ(data.measured_count(), 2 * (799 * 14 - 1));
}

// Thesis 4.2, step 1: the inverse magnitude, what is below the cut-off weighs no more than it.
TEST(FitData, WeighsByTheInverseMagnitudeDownToTheCutOff) {
  FrfFaults faults;
  faults.noisy = false;
  const auto set = simulators::beam5x3(faults).measured;
  double largest = 0.0;
  for (const auto& line : set.value) largest = std::max(largest, line.cwiseAbs().maxCoeff());
  FitDataOptions options;
  options.weighting = Weighting::inverse_magnitude;
  options.cut_off_db = 60.0;
  const auto data = fit_data(set, options);
  EXPECT_FALSE(data.noise_known);
  EXPECT_FALSE(data.weights_are_deviations);
  EXPECT_TRUE(std::isnan(noise_of(data)));
  EXPECT_GT(noise_of(fit_data(set)), 0.0);
  EXPECT_NEAR(data.weight.maxCoeff() * largest, 1e3, 1e-6);
  for (Eigen::Index k = 40; k < 100; ++k) {  // smooth there
    const double size = std::abs(data.value(k, 0));
    if (size < 2e-3 * largest) continue;
    EXPECT_NEAR(data.weight(k, 0) * size, 1.0, 0.1);
  }
  // Clipped minima: no line weighs less than one 20 dB below the peak, the others as before.
  options.clip_db = 20.0;
  const auto clipped = fit_data(set, options);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const double least = std::min(10.0 * data.weight.col(e).minCoeff(), 1e3 / largest);
    const Eigen::VectorXd expected = data.weight.col(e).cwiseMax(least);
    EXPECT_LT((clipped.weight.col(e) - expected).norm(), 1e-9 * expected.norm()) << e;
  }
}

// The part that the model's own error has of the squared deviations: less the more noise there is.
TEST(FitData, TellsThePartOfTheModelsError) {
  auto set = simulators::beam5x3().measured;
  EXPECT_EQ(fit_data(set).error_share, 0.0);
  const double error = 0.01;
  const auto data = fit_data(set, {.model_error = error});
  double expected = 0.0;
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    const Eigen::ArrayXXd allowed = error * error * set.value[k].array().abs2();
    expected += (allowed / (allowed + set.variance[k].array())).mean();
  }
  expected /= static_cast<double>(set.value.size());
  EXPECT_NEAR(data.error_share, expected, 0.02);  // there the size is not smoothed
  EXPECT_LT(fit_data(set, {.model_error = 0.1 * error}).error_share, data.error_share);
  set.averages = 2.0;  // too few for more than proportions
  EXPECT_EQ(fit_data(set, {.model_error = error}).error_share, 1.0);
  set.variance.clear();
  EXPECT_EQ(fit_data(set, {.model_error = error}).error_share, 1.0);
}

TEST(FitData, IsTheSameFromAnyKindOfResponse) {
  const auto set = simulators::beam5x3().measured;
  const auto direct = fit_data(set);
  const auto turned = fit_data(modal::converted(set, modal::FrfKind::accelerance));
  EXPECT_LT((turned.value - direct.value).norm(), 1e-12 * direct.value.norm());
  EXPECT_LT((turned.weight - direct.weight).norm(), 1e-12 * direct.weight.norm());
}

// A variance of 0 is none: the response would weigh as no measurement can.
TEST(FitData, NamesTheResponseThatHasNoVariance) {
  auto set = simulators::beam5x3().measured;
  for (auto& line : set.variance) line(1, 2) = 0.0;
  try {
    (void)fit_data(set);
    FAIL() << "taken";
  } catch (const InvalidInput& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("response y2/u3"), std::string::npos) << text;
    EXPECT_NE(text.find("expected variances above 0"), std::string::npos) << text;
  }
  for (auto& line : set.value)
    line(1, 2) = std::nan("");  // not measured: its variance says nothing
  EXPECT_TRUE(fit_data(set).noise_stated);
  for (auto& line : set.variance) line.setZero();
  EXPECT_FALSE(fit_data(set).noise_stated);
  EXPECT_FALSE(fit_data(set).noise_known);
}

// Exporters fill a matrix of responses with zeros, variances too: that is no measurement.
TEST(FitData, CountsZerosWithoutAVarianceAsNotMeasured) {
  auto set = simulators::beam5x3().measured;
  auto without = set;
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    set.value[k](1, 2) = set.variance[k](1, 2) = 0.0;
    without.value[k](1, 2) = kMissing;
  }
  const auto data = fit_data(set);
  const auto expected = fit_data(without);
  EXPECT_EQ(data.measured_count(), 2 * 799 * 14);
  EXPECT_EQ(data.weight, expected.weight);
  EXPECT_EQ(data.value, expected.value);
  // Where no variance is stated of any response, zeros may be meant.
  set.variance.clear();
  EXPECT_THROW((void)fit_data(set), InvalidInput);
}

// Lines that were not measured may be NaN, or 0 beside a variance of 0.
TEST(FitData, NamesTheResponseThatWasMeasuredOnTooFewLines) {
  for (const auto nothing : {kMissing, std::complex<double>(0.0)}) {
    for (const bool has_variance : {true, false}) {
      auto set = simulators::beam5x3().measured;
      for (std::size_t k = 0; k < set.value.size(); ++k) {
        if (k >= 5) set.value[k](3, 1) = nothing;
        if (k >= 5 || !has_variance) set.variance[k](3, 1) = 0.0;
      }
      if (nothing == 0.0 && !has_variance) continue;  // 799 lines without a variance
      try {
        (void)fit_data(set);
        FAIL() << "taken";
      } catch (const InvalidInput& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("response y4/u2: measured on 5 of 799 lines"), std::string::npos)
            << text;
        EXPECT_NE(text.find("set all its values to NaN"), std::string::npos) << text;
      }
    }
  }
}

TEST(FitData, NamesWhatIsWrong) {
  auto set = beam(0.3);
  FitDataOptions narrow;
  narrow.low_hz = 100.0;
  narrow.high_hz = 101.75;  // 8 lines
  EXPECT_THROW((void)fit_data(set, narrow), InvalidInput);
  narrow.high_hz = 102.0;
  EXPECT_EQ(fit_data(set, narrow).line_count(), 9);
  auto few = set;
  for (std::size_t k = 5; k < few.value.size(); ++k) few.value[k](3, 1) = kMissing;
  EXPECT_THROW((void)fit_data(few), InvalidInput);
  set.variance[7](3, 1) = -1.0;
  try {
    (void)fit_data(set);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("y4/u2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace chladni::identification
