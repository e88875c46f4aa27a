// How the gain of a diagnosis is told, and what its modes and constants say.
#include <gtest/gtest.h>

#include "rotation/turn.h"
#include "tests/steps/told_diagnosis.h"

namespace chladni::steps {
namespace {

// The answer is then that of the responses, or that the model is as good as its modes say.
TEST_F(Told, WhatResponsesDoNotExplainIsAskedOfTheirModes) {
  EVERY_FOURTH_LANDING();
  auto study =
      study_of({cause("point_mass", {}, {{"mass", 0.2}, {"u", 0.1}, {"v", -0.05}})}, "\"delay\"");
  const auto one = diagnosed_of(study);
  ASSERT_TRUE(one.by_modes) << show::diagnosis_table(one);
  if (one.result.verdict != Verdict::unexplained) {
    EXPECT_EQ(one.result.verdict, Verdict::no_discrepancy) << show::diagnosis_table(one);
    EXPECT_TRUE(steps::is_of_modes(one)) << show::diagnosis_table(one);
  }
  EXPECT_TRUE(one.result.best.causes.empty()) << show::diagnosis_table(one);
  EXPECT_FALSE(one.by_modes->modes.empty());
  const auto json = io::parse_json(left("diagnosis.json"));
  EXPECT_GT(json.at("by_modes").at("levels").at("frequency").at("before").number(), 0.0);
  EXPECT_GT(json.at("levels").at("frequency").at("after").number(), 0.0);
  EXPECT_NE(show::diagnosis_table(one).find("learned from their modes"), std::string::npos);
  study.diagnosis->levels = "known";
  EXPECT_FALSE(diagnosed_of(study).by_modes);
}

// Resonances beside each other: no gain of a sensor brings the responses nearer, but the shapes.
TEST_F(Told, AGainOfASensorIsJudgedByShapesWhereResonancesMiss) {
  const auto study = changed(
      study_of({cause("sensor_gain", {"s2"}, {{"relative", 0.5}})}, "\"sensor_gain\"", 0.03), "",
      "");
  const auto one = diagnosed_of(study);
  ASSERT_TRUE(steps::is_of_modes(one)) << show::diagnosis_table(one);
  ASSERT_FALSE(one.result.best.causes.empty()) << show::diagnosis_table(one);
  EXPECT_EQ(one.result.best.causes.front().effect, "sensor_gain");
  EXPECT_TRUE(one.gain.pays.value_or(false)) << show::diagnosis_table(one);
  EXPECT_LT(one.gain.shapes_after, 0.5 * one.gain.shapes_before);
  // The fitted model alone says nothing of causes that the modes name: it is not told to.
  auto unsolved = one;
  unsolved.gain.from = GainFrom::fitted_model;
  unsolved.gain.pays.reset();
  unsolved.gain.fitted_pays = false;
  const auto json = io::Json(show::diagnosis_json(unsolved));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(json.at("gain").at("pays").value()));
  EXPECT_EQ(show::diagnosis_table(unsolved).find("by it the causes"), std::string::npos);
  EXPECT_NE(one.result.verdict, Verdict::unexplained) << show::diagnosis_table(one);
  // Modes name the cause: there is no fit of responses whose misfit could be told.
  EXPECT_FALSE(json.at("left").at("per_channel").array().empty());
  EXPECT_THROW((void)json.at("left").at("misfit"), InvalidInput);
}

// A study that holds nothing out: parts of the data are held out in turn, and it is said which.
TEST_F(Told, AGainIsMeasuredOnUnseenDataWithoutBeingAsked) {
  const auto study =
      changed(study_of({cause("point_mass", {}, {{"mass", 0.2}, {"u", 0.1}, {"v", -0.05}})},
                       "\"point_mass\""),
              "", "");
  const auto one = diagnosed_of(study);
  ASSERT_EQ(one.result.verdict, Verdict::named) << show::diagnosis_table(one);
  ASSERT_TRUE(one.result.cross_validation);
  EXPECT_TRUE(one.gain.in_turn);
  EXPECT_TRUE(one.gain.pays.value_or(false));
  EXPECT_GT(one.gain.held_out_before, 0.2);
  EXPECT_LT(one.gain.held_out_after, 0.02);
  const auto text = show::diagnosis_table(one);
  for (const auto* part : {"each sensor in turn", "s1; s2; s3", "lines in turn", "upper band"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  const auto json = io::parse_json(left("diagnosis.json"));
  const auto& gain = json.at("gain");
  EXPECT_NEAR(gain.at("held_out").at("after").number(), one.gain.held_out_after, 1e-12);
  EXPECT_EQ(gain.at("cross_validation").at("parts").array().size(),
            one.result.cross_validation->parts.size());
  EXPECT_GT(gain.at("cross_validation").at("log_likelihood_gain_sensors").number(), 100.0);
  // What is left, response by response.
  const auto& before = json.at("discrepancy");
  const auto& after = json.at("left");
  EXPECT_LT(after.at("relative_error").number(), 3.0 * after.at("noise_floor").number());
  EXPECT_GT(before.at("relative_error").number(), 10.0 * after.at("relative_error").number());
  ASSERT_EQ(after.at("per_channel").array().size(), before.at("per_channel").array().size());
  for (std::size_t k = 0; k < after.at("per_channel").array().size(); ++k) {
    const auto& was = before.at("per_channel").array()[k];
    const auto& is = after.at("per_channel").array()[k];
    EXPECT_EQ(is.at("sensor").string(), was.at("sensor").string());
    EXPECT_LT(is.at("relative_error").number(), 0.1 * was.at("relative_error").number());
    EXPECT_EQ(is.at("noise_floor").number(), was.at("noise_floor").number());
    EXPECT_LE(std::abs(is.at("lag_one").number()), 1.0);
  }
  EXPECT_GT(before.at("misfit_lag_one").number(), 0.5);
  EXPECT_LT(std::abs(after.at("misfit").at("misfit_lag_one").number()), 0.3);
  EXPECT_NE(text.find("left with the causes: most in s"), std::string::npos) << text;
}

// Modes and errors, before and after: of the text, the JSON and the pictures.
TEST_F(Told, BeforeAndAfterStandSideBySide) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of({cause("point_mass", {}, {{"mass", 0.2}, {"u", 0.1}, {"v", -0.05}})},
                              "\"point_mass\"");
  const auto one = diagnosed_of(study);
  ASSERT_FALSE(one.modes_compared.empty());
  double before = 0.0, after = 0.0;
  for (const auto& mode : one.modes_compared) {
    EXPECT_GT(mode.measured_std_hz, 0.0);
    if (!std::isfinite(mode.before_hz + mode.after_hz)) continue;
    before = std::max(before, std::abs(mode.before_hz / mode.measured_hz - 1.0));
    after = std::max(after, std::abs(mode.after_hz / mode.measured_hz - 1.0));
  }
  EXPECT_GT(before, 5e-3);
  EXPECT_LT(after, 1e-3);
  // After, the error is within the band.
  const auto& errors = one.errors;
  ASSERT_EQ(errors.frequency_hz.size(), 120);
  EXPECT_TRUE((errors.expected.array() >= errors.noise.array()).all());
  EXPECT_LT(errors.after.mean(), 2.0 * errors.expected.mean());
  EXPECT_GT(errors.before.mean(), 5.0 * errors.after.mean());
  const auto text = show::diagnosis_table(one);
  EXPECT_NE(text.find("sound model"), std::string::npos) << text;
  EXPECT_NE(text.find("on the body: one thing at ("), std::string::npos) << text;
  const auto json = io::parse_json(left("diagnosis.json"));
  EXPECT_EQ(json.at("modes").array().size(), one.modes_compared.size());
  EXPECT_GT(json.at("modes").array().front().at("measured_std_hz").number(), 0.0);
  EXPECT_EQ(json.at("errors_over_frequency").at("after").array().size(), 120U);
  // Near the mass, by the distance of the scan's places.
  const auto& place = json.at("error_on_body").at("place_m").array();
  EXPECT_NEAR(place[0].number(), 0.1, 0.08);
  EXPECT_NEAR(place[1].number(), -0.05, 0.08);
}

// Responses softer or stiffer than the study, whose modulus is known to 10 %: calibrated, and no
// cause. From the study's resonances, up to ten bandwidths off, no fit comes there.
TEST_F(Told, AConstantThatIsNotKnownIsCalibratedByResponses) {
  EVERY_FOURTH_LANDING();
  for (const double by : {-0.08, 0.06, 0.12}) {
    const auto sound = study_of({cause("youngs_modulus", {}, {{"relative", by}})}, kThree);
    const auto study =
        changed(sound, "= \"70 GPa\"", "= { value = \"70 GPa\", within = \"10 %\" }");
    const auto one = diagnosed_of(study);
    EXPECT_EQ(one.result.verdict, Verdict::no_discrepancy) << by;
    EXPECT_LT(std::abs(one.result.excess_before), 2.0) << by;
    expect_calibrated(study, one, by);
  }
}

}  // namespace
}  // namespace chladni::steps
