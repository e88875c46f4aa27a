// Laws of the diagnosis of several specimens of one design.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/modes/specimens/hypotheses.h"
#include "diagnosis/modes/specimens/linearised.h"
#include "diagnosis/modes/specimens/slopes.h"
#include "diagnosis/modes/specimens/specimen_constants.h"
#include "diagnosis/specimens.h"
#include "simulators/portable_random.h"
#include "simulators/series/plate_series.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = CalibratedConstant::Kind;

constexpr Index kBodies = 5, kModes = 6;

// Five bodies of six modes: f follows a stiffness, a density and the thickness; each was weighed.
Series small_series(unsigned seed) {
  simulators::Dice dice(seed);
  const Index n = kBodies * (kModes + 1);
  Series series;
  series.modes = kModes;
  series.error = series.noise = VectorXd::Zero(n);
  const auto constant = [&](const char* name, double width) {
    return Series::Constant{{name, "1", 1.0, name, width, Kind::known},
                            width,
                            MatrixXd::Zero(n, kBodies),
                            VectorXd::Zero(kBodies)};
  };
  series.constants = {constant("modulus", 0.2), constant("density", 0.1)};
  for (Index b = 0; b < kBodies; ++b) {
    series.bodies.push_back("b" + std::to_string(b));
    series.group.push_back(b);
    for (const char* name : {"thickness", "mass"}) {
      series.entries.push_back(
          {{name, "1", 1.0, name, 0.01, Kind::measured}, b, true, VectorXd::Zero(n)});
    }
    auto& thickness = series.entries[at(2 * b)].slope;
    auto& mass = series.entries[at(2 * b + 1)].slope;
    for (Index k = 0; k <= kModes; ++k) {
      const Index row = b * (kModes + 1) + k;
      const bool is_mass = k == kModes;
      series.rows.push_back({b, b, is_mass ? -1 : k, k});
      series.constants[0].slope(row, b) = is_mass ? 0.0 : 0.5;
      series.constants[1].slope(row, b) = is_mass ? 1.0 : -0.5;
      thickness(row) = 1.0;
      mass(row) = is_mass ? -1.0 : 0.0;
      series.error(row) = is_mass ? 0.0 : 0.004 * dice.normal();
    }
    series.error += 0.05 * dice.normal() * series.constants[0].slope.col(b);
    series.error += 0.02 * dice.normal() * series.constants[1].slope.col(b);
  }
  return series;
}

// ln of the normal density by the eigenvalues of the whole covariance: no code of JointModel's.
double log_density(const MatrixXd& covariance, const VectorXd& x) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(covariance);
  const VectorXd along = parts.eigenvectors().transpose() * x;
  return -0.5 * (along.cwiseAbs2().cwiseQuotient(parts.eigenvalues()).sum() +
                 parts.eigenvalues().array().log().sum());
}

TEST(Specimens, WhatAnEntryPromisesIsItsRatioOfDensities) {
  const Series series = small_series(1);
  const JointModel model(series, true);
  const JointFit none = model.fitted({}, {});
  const MatrixXd before = none.inverse.inverse();
  for (const Index e : {0, 3, 7}) {
    const VectorXd& slope = series.entries[at(e)].slope;
    const MatrixXd after =
        before + kSpecimens.blunder * kSpecimens.blunder * slope * slope.transpose();
    EXPECT_NEAR(model.promise(none, {{e}}),
                log_density(after, series.error) - log_density(before, series.error), 1e-7);
  }
}

TEST(Specimens, TheLevelsAreAMaximum) {
  const Series series = small_series(2);
  const JointModel model(series, true);
  const JointFit best = model.fitted({}, {});
  VectorXd far = best.ln_levels;
  far(0) += 1.0;
  far(1) -= 1.0;
  const JointFit again = model.fitted({}, far);  // another start comes to the same levels
  EXPECT_NEAR(again.log_evidence, best.log_evidence, 0.02);
  EXPECT_LT((again.ln_levels - best.ln_levels).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Specimens, AThickSheetIsNotAHeavyOne) {
  for (const Index wrong : {2, 3}) {  // thickness and mass of the second body
    Series series = small_series(3);
    series.error += 0.2 * series.entries[at(wrong)].slope;
    const JointModel model(series, true);
    const auto weighed = weighed_hypotheses(model, series, 1);
    EXPECT_EQ(weighed.fits.front().supposed.entries, std::vector<Index>{wrong});
    const auto found = model.entry(weighed.fits.front(), at(wrong));
    EXPECT_NEAR(found(0), 0.2, 2.5 * std::sqrt(found(1)));
  }
}

TEST(Specimens, AFrequencyThatNoConstantsHaveIsSetAside) {
  Series series = small_series(4);
  series.error(9) += 0.15;
  const auto strays = set_strays_aside(series, true);
  EXPECT_EQ(strays, std::vector<Index>{9});
  Series sound = small_series(4);
  EXPECT_TRUE(set_strays_aside(sound, true).empty());
}

TEST(Specimens, ABodyThatIsMeasuredAgainHasOneOwnError) {
  // Twice the same numbers of one body tell its constants no better than once, beside its own
  // error.
  Series once = small_series(5);
  Series twice = once;
  const Index n = once.count(), more = kModes;
  const auto grow = [&](auto& values) {
    const MatrixXd again = values.topRows(more);
    values.conservativeResize(n + more, values.cols());
    values.bottomRows(more) = again;
  };
  grow(twice.error);
  grow(twice.noise);
  for (auto& one : twice.constants) grow(one.slope);
  for (auto& one : twice.entries) grow(one.slope);
  for (Index k = 0; k < more; ++k) twice.rows.push_back(twice.rows[at(k)]);
  const JointModel model(once, true), again(twice, true);
  const auto a = model.constant(model.fitted({}, {}), 0);
  const auto b = again.constant(again.fitted({}, {}), 0);
  EXPECT_NEAR(b.mean(0), a.mean(0), 0.1 * std::sqrt(a.covariance(0, 0)));
  EXPECT_NEAR(std::sqrt(b.covariance(0, 0)), std::sqrt(a.covariance(0, 0)),
              0.05 * std::sqrt(a.covariance(0, 0)));
}

simulators::PlateSeriesOptions few_plates() {
  simulators::PlateSeriesOptions options;
  options.specimens = 4;
  options.shapes = false;
  options.least = options.most = 0.2;
  return options;
}

TEST(Specimens, FrequenciesFollowTheSlopes) {
  const auto series = simulators::plate_series(1, "none", few_plates());
  const SpecimenModels models(series.specimens, {});
  const auto& one = *models.all().front();
  const MatrixXd slopes = frequency_slopes(*one.problem, one.fit, one.fit.model);
  constexpr double kStep = 1e-3;
  for (Index c = 0; c < slopes.cols(); ++c) {
    ModesFit there;
    there.constants = one.fit.constants;
    there.constants(c) += kStep;
    const auto modes = one.problem->modes(one.problem->with(there), false);
    ASSERT_TRUE(modes && modes->count() == one.fit.model.count());
    for (Index k = 0; k < 8; ++k) {
      const double change =
          std::log(modes->frequency_hz(k) / one.fit.model.frequency_hz(k)) / kStep;
      EXPECT_NEAR(slopes(k, c), change, 0.01) << "constant " << c << ", mode " << k;
    }
  }
}

// A plate that is longer and wider by one factor has frequencies of its power −2.
TEST(Specimens, LengthAndWidthTogetherScaleThePlate) {
  const auto series = simulators::plate_series(1, "none", few_plates());
  const SpecimenModels models(series.specimens, {});
  const auto& one = *models.all().front();
  const VectorXd both = length_slopes(*one.problem, one.fit, one.fit.model, true) +
                        length_slopes(*one.problem, one.fit, one.fit.model, false);
  for (Index k = 0; k < 8; ++k) EXPECT_NEAR(both(k), -2.0, 0.03) << "mode " << k;
}

TEST(Specimens, TheSheetThatIsWrongIsNamed) {
  const auto series = simulators::plate_series(2, "thickness", few_plates());
  const auto found = diagnosed(series.specimens);
  ASSERT_EQ(found.verdict, Verdict::named);
  ASSERT_EQ(found.best.entries.size(), 1U);
  const auto& entry = found.best.entries.front();
  EXPECT_EQ(entry.specimen, series.specimens[at(series.odd)].name);
  EXPECT_EQ(entry.effect, "thickness");
  EXPECT_GT(entry.probability, 0.8);
  EXPECT_NEAR(std::log(entry.value / entry.of_study), series.odd_change,
              3.0 * entry.std / entry.value);
  ASSERT_FALSE(found.proposals.empty());
  EXPECT_NE(found.measure_next.find(entry.specimen), std::string::npos) << found.measure_next;
}

TEST(Specimens, ASoundSeriesIsNotAccused) {
  const auto series = simulators::plate_series(3, "none", few_plates());
  const auto found = diagnosed(series.specimens);
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy);
  EXPECT_TRUE(found.best.entries.empty());
  EXPECT_EQ(found.specimens.size(), 4U);
}

TEST(Specimens, TheirOrderDoesNotMatter) {
  auto series = simulators::plate_series(2, "thickness", few_plates());
  const auto found = diagnosed(series.specimens);
  std::ranges::reverse(series.specimens);
  const auto reversed = diagnosed(series.specimens);
  EXPECT_EQ(reversed.verdict, found.verdict);
  EXPECT_NEAR(reversed.none, found.none, 0.02);
  EXPECT_EQ(reversed.entries.front().specimen, found.entries.front().specimen);
  EXPECT_NEAR(reversed.entries.front().probability, found.entries.front().probability, 0.03);
}

TEST(Specimens, WhatIsNoSeriesIsRefused) {
  auto series = simulators::plate_series(1, "none", few_plates());
  EXPECT_THROW(check({series.specimens.front()}), InvalidInput);
  auto twice = series.specimens;
  twice[1].name = twice[0].name;
  EXPECT_THROW(check(twice), InvalidInput);
  auto later = series.specimens;
  later[0].same_as = later[1].name;
  EXPECT_THROW(check(later), InvalidInput);
  auto known = series.specimens;
  known[2].constants.clear();
  EXPECT_THROW(check(known), InvalidInput);
  auto zero = series.specimens;
  zero[2].constants.back().deviation = 0.0;
  EXPECT_THROW(check(zero), InvalidInput);
}

}  // namespace
}  // namespace chladni::diagnosis
