// What a diagnosis tells where responses and their modes are both diagnosed, on results that are
// made up.
#include "steps/diagnosis/by_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/error.h"
#include "steps/diagnosis/responses_in_band.h"
#include "steps/measured_modes.h"
#include "tests/refusal.h"

namespace chladni::steps {
namespace {

using diagnosis::Diagnosis;
using diagnosis::Verdict;

diagnosis::Cause cause(const std::string& effect, double probability) {
  diagnosis::Cause made;
  made.effect = effect;
  made.probability = probability;
  return made;
}

// Levels of frequencies without a cause and beside it.
Diagnosis told(Verdict verdict, const std::vector<diagnosis::Cause>& causes, double before,
               double after) {
  const auto level = [](double value) {
    diagnosis::ErrorLevel one;
    one.of = "frequency";
    one.value = value;
    one.determined = 8.0;
    return one;
  };
  Diagnosis made;
  made.verdict = verdict;
  made.best.causes = causes;
  made.best.probability = causes.empty() ? 1.0 : causes.front().probability;
  made.levels_before = {level(before)};
  made.levels_after = {level(after)};
  return made;
}

// The same, told of modes: there is one.
Diagnosis told_of_modes(Verdict verdict, const std::vector<diagnosis::Cause>& causes, double before,
                        double after) {
  auto made = told(verdict, causes, before, after);
  made.modes = {diagnosis::ModeTold{}};
  return made;
}

// Three sensors and an actuator.
Diagnosed diagnosed_twice(Diagnosis of_responses, Diagnosis of_modes) {
  Diagnosed one;
  one.seen.outputs.resize(3);
  one.seen.inputs.resize(1);
  one.result = std::move(of_responses);
  one.by_modes = std::move(of_modes);
  return one;
}

Diagnosis open_responses(Verdict verdict = Verdict::unexplained) {
  Diagnosis made;
  made.verdict = verdict;
  made.excess_before = 1000.0;
  made.best.excess = 900.0;
  return made;
}

TEST(ByModes, WhatResponsesExplainIsTheirAnswer) {
  auto one =
      diagnosed_twice(told(Verdict::named, {cause("point_mass", 0.9)}, 0.0, 0.0),
                      told_of_modes(Verdict::named, {cause("sensor_gain", 0.9)}, 0.02, 0.02));
  take_answer_of_modes(one, {});
  EXPECT_FALSE(is_of_modes(one));
  EXPECT_EQ(one.result.best.causes.front().effect, "point_mass");
  one.gain.pays = false;  // their own test of held-out data judges them, not this
  believe_what_pays(one);
  EXPECT_EQ(one.result.verdict, Verdict::named);
  EXPECT_EQ(one.result.best.causes.front().probability, 0.9);
}

TEST(ByModes, CausesOfModesMustPay) {
  for (const auto verdict : {Verdict::named, Verdict::ambiguous}) {
    auto one = diagnosed_twice(open_responses(),
                               told_of_modes(verdict, {cause("point_mass", 0.9)}, 0.02, 0.0003));
    take_answer_of_modes(one, {});
    EXPECT_TRUE(is_of_modes(one));
    EXPECT_EQ(one.result.verdict, verdict);
    EXPECT_EQ(one.result.levels_after.front().value, 0.0003);
    auto pays = one;
    pays.gain.pays = true;
    believe_what_pays(pays);
    EXPECT_EQ(pays.result.verdict, verdict);
    one.gain.pays = false;
    believe_what_pays(one);
    EXPECT_EQ(one.result.verdict, Verdict::unexplained);
    EXPECT_LE(one.result.best.causes.front().probability, 0.5);
    EXPECT_EQ(one.result.levels_after.front().value, 0.02)
        << "the level beside a cause not believed";
  }
}

// What was said of other causes is not said beside those that replace them.
TEST(ByModes, LeaveNoNotesOnOtherCauses) {
  auto responses = open_responses();
  responses.best.causes = {cause("ground_spring", 0.2)};
  responses.notes = {"s4 is left out", "the springs are near each other"};
  responses.data_notes = {"s4 is left out"};
  responses.map.explained = responses.map.posterior = Eigen::VectorXd::Ones(3);
  responses.before.per_output = Eigen::VectorXd::Constant(3, 90.0);
  responses.after.per_output = Eigen::VectorXd::Constant(3, 80.0);
  auto by_modes = told_of_modes(Verdict::named, {cause("point_mass", 0.9)}, 0.02, 0.0003);
  by_modes.notes = {"s4 is left out", "labels of sensors are mixed"};
  auto one = diagnosed_twice(responses, by_modes);
  take_answer_of_modes(one, {});
  ASSERT_EQ(one.result.notes.size(), 3U);
  EXPECT_EQ(one.result.notes.front(), "s4 is left out");
  EXPECT_EQ(one.result.notes[1], "labels of sensors are mixed") << "said of the causes told";
  EXPECT_NE(one.result.notes.back().find("learned from their modes"), std::string::npos);
  EXPECT_EQ(one.result.map.explained.size(), 0) << "the place of a spring";
  EXPECT_EQ(one.result.after.per_output, one.result.before.per_output);
  responses.best.causes.clear();
  auto without = diagnosed_twice(responses, by_modes);
  take_answer_of_modes(without, {});
  EXPECT_EQ(without.result.map.explained.size(), 3) << "that of the simulation itself";
}

// Levels beside a cause are those of no model where the cause is not taken.
TEST(ByModes, LevelsAreThoseOfWhatIsTold) {
  auto partial = open_responses(Verdict::partial);
  partial.best.causes = {cause("ground_spring", 0.8)};
  auto one = diagnosed_twice(
      partial, told_of_modes(Verdict::ambiguous, {cause("youngs_modulus", 0.6)}, 0.03, 0.0005));
  take_answer_of_modes(one, {});
  EXPECT_EQ(one.result.verdict, Verdict::partial);
  EXPECT_EQ(one.result.best.causes.front().effect, "ground_spring");
  EXPECT_EQ(one.result.levels_after.front().value, 0.03);
}

TEST(ByModes, ErrorsOfRealModelsAreNoDiscrepancy) {
  auto one =
      diagnosed_twice(open_responses(), told_of_modes(Verdict::no_discrepancy, {}, 0.02, 0.02));
  ASSERT_TRUE(is_less_good(one, {}));
  take_answer_of_modes(one, {});
  EXPECT_EQ(one.result.verdict, Verdict::no_discrepancy);
  auto far =
      diagnosed_twice(open_responses(), told_of_modes(Verdict::no_discrepancy, {}, 0.08, 0.08));
  take_answer_of_modes(far, {});
  EXPECT_EQ(far.result.verdict, Verdict::unexplained);
}

TEST(ByModes, AFirstLookIsWorthASearchWhereOneCauseExplainsMuch) {
  auto one =
      diagnosed_twice(open_responses(), told_of_modes(Verdict::no_discrepancy, {}, 0.02, 0.02));
  EXPECT_TRUE(beside_modes(one, {}).is_look);
  EXPECT_FALSE(is_promising(one)) << "no cause at all";
  one.result.best.causes = {cause("resonator", 0.0)};
  EXPECT_FALSE(is_promising(one));
  one.result.best.excess = 500.0;
  EXPECT_TRUE(is_promising(one));
  one.result.verdict = Verdict::named;  // a look has no last word
  EXPECT_TRUE(is_promising(one));
  one.by_modes->levels_after.front().value = 0.0005;
  EXPECT_FALSE(beside_modes(one, {}).is_look) << "the model is as good as its tolerances";
}

// Measured at 100 Hz each; NaN: like no simulated mode.
Diagnosed with_modes_at(const std::vector<double>& simulated_hz) {
  auto one = diagnosed_twice(open_responses(), {});
  for (const double hz : simulated_hz) {
    one.modes_compared.emplace_back();
    one.modes_compared.back().measured_hz = 100.0;
    one.modes_compared.back().before_hz = hz;
  }
  return one;
}

TEST(ByModes, AreAskedFirstWhereTheyAreOthers) {
  EXPECT_FALSE(has_other_modes(with_modes_at({}), {}));
  EXPECT_FALSE(has_other_modes(with_modes_at({97.0, 97.0, 97.05}), {})) << "a scale of all";
  EXPECT_TRUE(has_other_modes(with_modes_at({97.0, 102.0, 99.0}), {}));
  EXPECT_TRUE(has_other_modes(with_modes_at({NAN, NAN, 99.0}), {}));
  auto few = with_modes_at({97.0, 102.0, 99.0});
  few.seen.outputs.resize(1);
  EXPECT_FALSE(has_other_modes(few, {})) << "two channels";
}

// The fit of some responses has nothing but poles far off and filling.
TEST(ByModes, NeedAMode) {
  diagnosis::MeasuredModes none;
  none.outputs = {"s1"};
  none.inputs = {"a1"};
  none.output_shapes.resize(1, 0);
  none.input_shapes.resize(1, 0);
  stage::Work work;
  const auto said = refusal_of([&] { return clear_modes(none, work); });
  EXPECT_NE(said.find("no mode can be identified"), std::string::npos) << said;
  study::Study study;
  study.file = "p1.toml";
  study.measurement.emplace();
  const auto below = refusal_of([&] { return modes_below(100.0, none, study, work); });
  EXPECT_NE(below.find("p1.toml: no mode"), std::string::npos) << below;
}

// What is found beside a model that is off by 2 % is more than what its tolerances say.
TEST(ByModes, DetectableSizesAreThoseBesideTheLearnedErrors) {
  const diagnosis::DiagnosisOptions options;
  auto one =
      diagnosed_twice(open_responses(), told_of_modes(Verdict::no_discrepancy, {}, 0.02, 0.02));
  EXPECT_EQ(beside_errors(one, options).tolerances.frequency, options.tolerances.frequency);
  take_answer_of_modes(one, options);
  EXPECT_EQ(beside_errors(one, options).tolerances.frequency, 0.02);
}

}  // namespace
}  // namespace chladni::steps
