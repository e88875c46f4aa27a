// Parts of recordings that a fit does not see. The recordings are those of the virtual laboratory,
// which shares no code with the estimators.
#include "identification/cross_validation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "identification/delay.h"
#include "identification/identified.h"
#include "tests/recordings/rigs.h"

namespace chladni::identification {
namespace {

using Eigen::Index;

const Estimator kOpenLoop = [](const recordings::Spectra& spectra,
                               const recordings::FrfEstimateOptions& options) {
  return frf_estimate(spectra, options);
};

struct Recorded {
  recordings::TimeData data;
  recordings::FrfEstimate estimate;
  Folds folds;
};

Recorded recorded_folds(int realisations, Index periods, unsigned seed) {
  auto rig = recordings::rig_of(recordings::two_modes(), 512.0);
  rig.sensor_noise = Eigen::Vector2d(1e-4, 1e-4);
  auto plan = recordings::plan_of_seconds(periods);
  plan.multisine.period = 2048;  // lines of 0.25 Hz
  plan.scheme = recordings::InputScheme::orthogonal;
  plan.warm_up = 4;
  Recorded result{virtual_experiment(rig, plan, realisations, seed), {}, {}};
  recordings::TransientReport about;
  const auto [all, options] = prepared(result.data, {.remove_transient = true}, about);
  result.estimate = frf_estimate(all, options);
  result.folds = folds(result.data, all, {.remove_transient = true}, 0, kOpenLoop);
  return result;
}

FitData data_of(const modal::FrfSet& set) { return fit_data(without_delay(set, 0.0, 1.0 / 512.0)); }

ModalFit fit_of(const FitData& data, Index modes) {
  return identified(data, {.modes = modes, .rigid_count = 0}).fit;
}

CrossValidation validated(const Folds& folds, Index modes) {
  std::vector<PredictedPart> parts;
  ModalFit fit;
  for (const auto& fold : folds.folds) {
    const auto rest = data_of(fold.rest);
    fit = fit_of(rest, modes);
    auto data = data_of(fold.left_out);
    const Eigen::MatrixXcd predicted = responses(fit, data.frequency_hz);
    const double error = fit_error_over_noise(data, rest, fit);
    parts.push_back({fold.name, std::move(data), predicted, error});
  }
  return cross_validation(folds.by, parts, fit.model.frequency_hz);
}

// The estimate is the mean over the realisations: of any fold the two sides give it back.
TEST(CrossValidation, FoldsAreTheTwoSidesOfTheEstimate) {
  const auto [data, estimate, folds] = recorded_folds(4, 4, 1);
  ASSERT_EQ(folds.by, "realisations");
  ASSERT_EQ(folds.folds.size(), 4U);
  EXPECT_EQ(folds.folds[2].name, "realisation 3");
  for (const auto& fold : folds.folds) {
    EXPECT_EQ(fold.times, 3.0);
    ASSERT_EQ(fold.rest.line_count(), estimate.set.line_count());
    for (std::size_t k = 0; k < estimate.set.value.size(); ++k) {
      const Eigen::MatrixXcd mean = 0.75 * fold.rest.value[k] + 0.25 * fold.left_out.value[k];
      EXPECT_LT((mean - estimate.set.value[k]).norm(), 1e-12 * estimate.set.value[k].norm());
      EXPECT_EQ(fold.left_out.variance[k], 3.0 * fold.rest.variance[k]);
    }
  }
}

TEST(CrossValidation, ARightModelLeavesTheNoiseOfWhatItHasNotSeen) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto found = validated(recorded_folds(5, 4, seed).folds, 2);
    const auto& whole = found.all.whole;
    EXPECT_NEAR(whole.level, found.expected_level, 4.0 * whole.level_deviation) << seed;
    EXPECT_NEAR(whole.relative_error, whole.relative_noise, 0.1 * whole.relative_noise);
    EXPECT_GT(found.expected_level, 1.0);
    ASSERT_EQ(found.parts.size(), 5U);
    for (const auto& part : found.parts) {
      EXPECT_NEAR(part.whole.level, found.expected_level, 4.0 * part.whole.level_deviation);
    }
  }
}

TEST(CrossValidation, AModelWithAModeTooFewLeavesMore) {
  const auto recorded = recorded_folds(5, 4, 4);
  const auto found = validated(recorded.folds, 1);
  EXPECT_GT(found.all.whole.level, found.expected_level + 20.0 * found.all.whole.level_deviation);
  for (const auto& part : found.parts) EXPECT_GT(part.whole.level, 2.0);
}

// Modes that are not there fit the noise: what was seen comes nearer, what was not goes away.
TEST(CrossValidation, ModesThatAreNotTherePredictWorse) {
  const auto recorded = recorded_folds(3, 4, 5);
  const auto data = data_of(recorded.estimate.set);
  const auto right = fit_of(data, 2);
  const auto many = fit_of(data, 8);
  ASSERT_GT(many.model.mode_count(), 5);
  EXPECT_LT(many.cost, right.cost);
  const auto of_right = validated(recorded.folds, 2);
  const auto of_many = validated(recorded.folds, 8);
  EXPECT_GT(of_many.all.whole.level, of_right.all.whole.level);
  EXPECT_GT(of_many.all.whole.relative_error, of_right.all.whole.relative_error);
  EXPECT_GT(of_many.expected_level, of_right.expected_level);
}

// One realisation: its periods tell as much of the noise.
TEST(CrossValidation, StretchesOfOneRealisationStandForRealisations) {
  const auto recorded = recorded_folds(1, 9, 6);
  ASSERT_EQ(recorded.folds.by, "periods");
  ASSERT_EQ(recorded.folds.folds.size(), 4U);
  const auto found = validated(recorded.folds, 2);
  EXPECT_NEAR(found.all.whole.level, found.expected_level, 4.0 * found.all.whole.level_deviation);
  EXPECT_TRUE(recorded_folds(1, 3, 6).folds.folds.empty());
}

// They count as equal: a longer one would have less noise than is said of it.
TEST(CrossValidation, StretchesAreOfOneLength) {
  const auto recorded = recorded_folds(1, 8, 6);
  recordings::TransientReport about;
  const auto [all, options] = prepared(recorded.data, {}, about);
  std::set<std::size_t> periods;
  const Estimator looking = [&](const recordings::Spectra& spectra,
                                const recordings::FrfEstimateOptions& how) {
    for (const auto& record : spectra.records) periods.insert(record.outputs.size());
    return frf_estimate(spectra, how);
  };
  for (const Index dropped : {0, 1, 2, 3}) {  // 8 to 5 periods
    periods.clear();
    const auto found = folds(recorded.data, all, {}, dropped, looking);
    EXPECT_EQ(found.folds.size(), static_cast<std::size_t>((8 - dropped) / 2));
    EXPECT_EQ(periods, std::set<std::size_t>{2});
  }
}

TEST(CrossValidation, OfManyRealisationsSomeGoTogether) {
  const auto recorded = recorded_folds(12, 2, 7);
  ASSERT_EQ(recorded.folds.folds.size(), 10U);
  EXPECT_EQ(recorded.folds.folds[1].name, "realisations 2, 12");
  EXPECT_EQ(recorded.folds.folds[1].times, 5.0);
  EXPECT_EQ(recorded.folds.folds[2].times, 11.0);
  const auto found = validated(recorded.folds, 2);
  EXPECT_NEAR(found.all.whole.level, found.expected_level, 4.0 * found.all.whole.level_deviation);
}

// P parameters take P/2 of N complex numbers; the error of the fit on data as good as those it has
// seen is P/2N of their noise, on data of a tenth of the deviation a hundred times that.
TEST(CrossValidation, TheErrorOfAFitCountsAgainstTheNoiseOfItsData) {
  FitData seen;
  seen.outputs = seen.inputs = 1;
  seen.frequency_hz = Eigen::VectorXd::LinSpaced(50, 1.0, 50.0);
  seen.value.setOnes(50, 1);
  seen.weight.setConstant(50, 1, 2.0);
  ModalFit fit;
  fit.parameter_count = 10;
  auto other = seen;
  EXPECT_DOUBLE_EQ(fit_error_over_noise(other, seen, fit), 0.1);
  other.weight.setConstant(20.0);
  other.frequency_hz.array() += 0.3;
  EXPECT_DOUBLE_EQ(fit_error_over_noise(other, seen, fit), 10.0);
}

}  // namespace
}  // namespace chladni::identification
