// What a cause gains, on responses that are made up.
#include "steps/diagnosis/diagnosis_gain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace chladni::steps {
namespace {

// Two sensors by two actuators on five lines; s2 is held out; every response is 1.
steps::MeasuredFrfs measured() {
  steps::MeasuredFrfs made;
  for (const auto* name : {"s1", "s2"}) made.all.outputs.emplace_back().name = name;
  for (const auto* name : {"a1", "a2"}) made.all.inputs.emplace_back().name = name;
  made.all.frequency_hz = Eigen::VectorXd::LinSpaced(5, 100.0, 140.0);
  made.all.value.assign(5, Eigen::MatrixXcd::Ones(2, 2));
  made.all.variance.assign(5, Eigen::MatrixXd::Constant(2, 2, 1e-4));
  made.outputs = {0};
  made.inputs = {0, 1};
  return made;
}

// Off by `fit` where it is fitted and by `held_out` at s2.
std::vector<Eigen::MatrixXcd> off_by(double fit, double held_out) {
  Eigen::MatrixXcd value(2, 2);
  value.row(0).setConstant(1.0 + fit);
  value.row(1).setConstant(1.0 + held_out);
  return std::vector<Eigen::MatrixXcd>(5, value);
}

steps::Gain gain(const steps::Predictions& predictions, const study::DiagnosisPlan& plan = {}) {
  return steps::gain_of(measured(), plan, {"s2"}, predictions);
}

TEST(Gain, OfNothingDoesNotPayAndDoesNotFailTo) {
  const auto found = gain({off_by(0.01, 0.02), {}, {}});
  EXPECT_EQ(found.from, steps::GainFrom::nothing);
  EXPECT_FALSE(found.pays.has_value());
  EXPECT_EQ(steps::advice_against(found), "");
  EXPECT_NEAR(found.fit_before, 0.01, 1e-12);
  EXPECT_NEAR(found.held_out_before, 0.02, 1e-12);
  EXPECT_NEAR(found.noise_floor, 0.01, 1e-12);
}

TEST(Gain, OfAnExtendedStudyPaysWhereItPredictsBetter) {
  const auto found = gain({off_by(0.3, 0.24), off_by(0.02, 0.03), {}});
  EXPECT_EQ(found.from, steps::GainFrom::extended_study);
  EXPECT_TRUE(found.pays.value_or(false));
  EXPECT_EQ(steps::advice_against(found), "");
  EXPECT_NEAR(found.held_out_after, 0.03, 1e-12);
}

TEST(Gain, ThatMakesWorseIsAdvisedAgainst) {
  const auto held = gain({off_by(0.3, 0.24), off_by(0.02, 0.38), {}});
  EXPECT_FALSE(held.pays.value_or(true));
  EXPECT_EQ(steps::advice_against(held),
            "The extended study predicts the responses that were held out no better than before "
            "(off by 38 %, before by 24 %): it is not recommended.");
  auto nothing_held_out = measured();
  nothing_held_out.outputs = {0, 1};
  const auto seen =
      steps::gain_of(nothing_held_out, {}, {}, {off_by(9.40, 9.40), off_by(9.46, 9.46), {}});
  EXPECT_FALSE(seen.pays.value_or(true));
  EXPECT_NE(steps::advice_against(seen).find("the fit saw no better than before (off by 946 %"),
            std::string::npos)
      << steps::advice_against(seen);
}

TEST(Gain, OfCausesThatNoStudyExpressesIsThatOfTheFittedModel) {
  const auto alone = gain({off_by(0.3, 0.24), {}, off_by(0.01, 0.02)});
  EXPECT_EQ(alone.from, steps::GainFrom::fitted_model);
  EXPECT_FALSE(alone.pays.has_value());
  EXPECT_TRUE(alone.fitted_pays.value_or(false));
  EXPECT_NEAR(alone.fit_after, 0.01, 1e-12);
  EXPECT_EQ(steps::advice_against(alone), "");
  // One cause of two is in the extended study: both are known.
  const auto both = gain({off_by(0.3, 0.24), off_by(0.1, 0.1), off_by(0.01, 0.02)});
  EXPECT_EQ(both.from, steps::GainFrom::fitted_model);
  EXPECT_NEAR(both.held_out_after, 0.02, 1e-12);
  EXPECT_NEAR(both.held_out_extended, 0.1, 1e-12);
  EXPECT_TRUE(both.pays.value_or(false));
  EXPECT_TRUE(both.fitted_pays.value_or(false));
  // Nearer to what was fitted and further from what was held out: it does not pay.
  const auto worse = gain({off_by(0.3, 0.24), {}, off_by(0.01, 0.38)});
  EXPECT_FALSE(worse.pays.has_value());
  EXPECT_FALSE(worse.fitted_pays.value_or(true));
  EXPECT_NE(steps::advice_against(worse), "");
  EXPECT_FALSE(gain({off_by(0.3, 0.24), off_by(0.02, 0.03), {}}).fitted_pays.has_value());
}

// A sensor at 40 % of its size before and 10 % after, a block of lines at 20 and 10 %.
diagnosis::CrossValidation tested_in_turn(double gain) {
  using Kind = diagnosis::HeldOutPart::Kind;
  diagnosis::CrossValidation tested;
  tested.parts.push_back({.kind = Kind::sensors,
                          .sensors = {"s1"},
                          .low_hz = 100.0,
                          .high_hz = 140.0,
                          .errors = {16.0, 1.0, 100.0, 0.25},
                          .gain = gain,
                          .gain_of_cause = {gain}});
  tested.parts.push_back({.kind = Kind::lines,
                          .sensors = {"s1", "s2"},
                          .low_hz = 100.0,
                          .high_hz = 120.0,
                          .errors = {4.0, 1.0, 100.0, 0.25},
                          .gain = 5.0,
                          .gain_of_cause = {5.0}});
  tested.parts.push_back({.kind = Kind::upper_band,
                          .sensors = {"s1", "s2"},
                          .low_hz = 124.0,
                          .high_hz = 140.0,
                          .errors = {1.0, 9.0, 100.0, 0.25},
                          .gain = -100.0,
                          .gain_of_cause = {-100.0}});
  return tested;
}

TEST(Gain, IsThatOfPartsInTurnWhereNothingIsHeldOut) {
  const auto pays = tested_in_turn(3.0);
  auto all_seen = measured();
  all_seen.outputs = {0, 1};
  const steps::Predictions predictions{off_by(0.3, 0.3), off_by(0.1, 0.1), {}};
  const auto found = steps::gain_of(all_seen, {}, {}, predictions, &pays);
  EXPECT_TRUE(found.in_turn);
  EXPECT_NEAR(found.held_out_before, std::sqrt(20.0 / 200.0), 1e-12);
  EXPECT_NEAR(found.held_out_after, std::sqrt(2.0 / 200.0), 1e-12);
  EXPECT_NEAR(found.held_out_noise, std::sqrt(0.5 / 200.0), 1e-12);
  EXPECT_EQ(found.held_out, (std::vector<std::string>{"s1", "100 to 120 Hz"}));
  EXPECT_TRUE(found.pays.value_or(false));
  EXPECT_EQ(steps::advice_against(found), "");

  const auto loses = tested_in_turn(-3.0);  // more than half of what the lines gain
  EXPECT_FALSE(steps::gain_of(all_seen, {}, {}, predictions, &loses).pays.value_or(true));
  const steps::Predictions reduced{off_by(0.3, 0.3), {}, off_by(0.1, 0.1)};
  const auto fitted_pays = [&](const diagnosis::CrossValidation& tested) {
    return steps::gain_of(all_seen, {}, {}, reduced, &tested).fitted_pays;
  };
  EXPECT_EQ(fitted_pays(pays), std::optional(true));
  EXPECT_EQ(fitted_pays(loses), std::optional(false));
  // What is stated goes first.
  const auto stated = steps::gain_of(measured(), {}, {"s2"}, predictions, &pays);
  EXPECT_FALSE(stated.in_turn);
  EXPECT_EQ(stated.held_out, std::vector<std::string>{"s2"});
  EXPECT_NEAR(stated.held_out_before, 0.3, 1e-12);
}

TEST(Gain, SaysWhatWasFittedAndWhatWasHeldOut) {
  study::DiagnosisPlan plan;
  plan.hold_out_low_hz = 115.0;
  plan.hold_out_high_hz = 125.0;
  const auto found = gain({off_by(0.3, 0.24), {}, {}}, plan);
  EXPECT_EQ(found.fitted.sensors, std::vector<std::string>{"s1"});
  EXPECT_EQ(found.fitted.actuators, (std::vector<std::string>{"a1", "a2"}));
  EXPECT_EQ(found.fitted.lines, 4);
  ASSERT_EQ(found.fitted.bands_hz.size(), 2U);
  EXPECT_NEAR(found.fitted.bands_hz[0].second, 110.0, 1e-9);
  EXPECT_NEAR(found.fitted.bands_hz[1].first, 130.0, 1e-9);
  EXPECT_EQ(found.held_out, (std::vector<std::string>{"s2", "115 to 125 Hz"}));
  EXPECT_EQ(steps::words(found.fitted), "s1 by a1, a2; 4 lines, 100 to 110 Hz, 130 to 140 Hz");
  // Lines of s1 that were held out count as held out: 2 of 2·5 + 2 responses are off by 0.3.
  EXPECT_NEAR(found.held_out_before, std::sqrt((2 * 0.09 + 10 * 0.0576) / 12.0), 1e-12);
}

// A cause that drives a mode away from every simulated one does not pay by losing it.
TEST(Gain, ByFrequenciesCountsAModeThatLosesItsPartner) {
  const auto mode = [](double before, double after) {
    diagnosis::ModeTold one;
    one.measured_hz = 100.0;
    one.before_hz = before;
    one.after_hz = after;
    return one;
  };
  const auto judged = [](const std::vector<diagnosis::ModeTold>& modes) {
    steps::Gain gain;
    gain.pays = false;
    steps::judge_by_modes(modes, gain);
    return gain;
  };
  EXPECT_TRUE(judged({mode(103.0, 100.5), mode(98.0, 99.0)}).pays.value_or(false));
  const auto lost = judged({mode(103.0, NAN), mode(98.0, 99.0)});
  EXPECT_FALSE(lost.pays.value_or(true));
  EXPECT_GT(lost.frequencies_after, lost.frequencies_before);
}

// A gain of a sensor moves no frequency; detuned responses say nothing of it.
TEST(Gain, ByShapesWhereNoFrequencyChanges) {
  const auto judged = [](double mac_before, double mac_after) {
    diagnosis::ModeTold mode;
    mode.measured_hz = 100.0;
    mode.before_hz = mode.after_hz = 103.0;
    mode.mac_before = mac_before;
    mode.mac_after = mac_after;
    steps::Gain gain;
    gain.pays = false;
    steps::judge_by_modes({mode, mode}, gain);
    return gain;
  };
  const auto nearer = judged(0.91, 0.96);
  EXPECT_TRUE(nearer.pays.value_or(false));
  EXPECT_NEAR(nearer.shapes_before, 0.3, 1e-12);
  EXPECT_NEAR(nearer.shapes_after, 0.2, 1e-12);
  EXPECT_TRUE(std::isnan(nearer.frequencies_after));
  EXPECT_FALSE(judged(0.96, 0.91).pays.value_or(true));
  EXPECT_FALSE(judged(0.96, NAN).pays.value_or(true));
}

}  // namespace
}  // namespace chladni::steps
