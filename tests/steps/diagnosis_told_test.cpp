// How a diagnosis is told: text, JSON, report and extended study of one that is known. What is
// found is not the question here.
#include <gtest/gtest.h>

#include "rotation/turn.h"
#include "steps/diagnosis/beside_measured.h"
#include "steps/diagnosis/responses_in_band.h"
#include "tests/steps/told_diagnosis.h"

namespace chladni::steps {
namespace {

TEST_F(Told, ASoundTableIsNotSaidNotToPay) {
  const auto study = study_of({}, "\"sensor_gain\", \"point_mass\"");
  const auto one = diagnosed_of(study);
  ASSERT_EQ(one.result.verdict, Verdict::no_discrepancy) << show::verdict_text(one);
  EXPECT_FALSE(one.gain.pays.has_value());
  EXPECT_EQ(said_.find("not recommended"), std::string::npos) << said_;
  EXPECT_EQ(said_.find("pay"), std::string::npos) << said_;
  const io::Json json = io::parse_json(left("diagnosis.json"));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(json.at("gain").at("pays").value()));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(json.at("gain").at("from").value()));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(json.at("left").value()));
  EXPECT_FALSE(std::filesystem::exists(at("out/extended.toml")));
  EXPECT_EQ(one.least_evidence, 9.0);
}

TEST_F(Told, TheVerdictStandsFirst) {
  const auto study = study_of({}, "\"sensor_gain\"");
  const auto text = show::diagnosis_table(diagnosed_of(study));
  EXPECT_TRUE(text.starts_with("verdict: no_discrepancy\nThe simulation agrees")) << text;
  EXPECT_LT(text.find("responses off by"), text.find("simulated Hz"));
}

TEST_F(Told, TablesBehindAVerdictThatExplainsComeOnlyWithAll) {
  const auto study = study_of({}, "\"sensor_gain\"");
  const auto one = diagnosed_of(study);
  const auto all = show::diagnosis_table(one);
  const auto first = show::diagnosis_table(one, false);
  EXPECT_NE(all.find("CoMAC"), std::string::npos) << all;
  EXPECT_EQ(first.find("CoMAC"), std::string::npos) << first;
  EXPECT_NE(first.find("responses off by"), std::string::npos) << first;
  EXPECT_NE(first.find("--all"), std::string::npos) << first;
  // What responses would show is no claim of modes that answer in their place.
  EXPECT_NE(first.find("This experiment finds"), std::string::npos) << first;
  auto of_modes = one;
  of_modes.result.modes = {diagnosis::ModeTold{}};
  EXPECT_EQ(show::diagnosis_table(of_modes, false).find("This experiment finds"),
            std::string::npos);
  auto open = one;
  open.result.verdict = diagnosis::Verdict::unexplained;
  EXPECT_NE(show::diagnosis_table(open, false).find("CoMAC"), std::string::npos);
}

TEST_F(Told, AUnitIsSaidEverywhereAndTheExtendedStudyHasIt) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of({cause("sensor_unit", {"s2"}, {}, "g taken for m/s^2")},
                              "\"sensor_unit\", \"sensor_gain\", \"sensor_sign\"");
  const auto one = diagnosed_of(study);
  ASSERT_EQ(one.result.verdict, Verdict::named) << show::diagnosis_table(one);
  ASSERT_EQ(one.result.best.causes.size(), 1U);
  EXPECT_NE(show::diagnosis_table(one).find("sensor_unit of s2: g taken for m/s^2"),
            std::string::npos)
      << show::diagnosis_table(one);
  const auto json = io::parse_json(left("diagnosis.json"));
  const auto& told = json.at("causes").array().front();
  EXPECT_EQ(told.at("option").string(), "g taken for m/s^2");
  EXPECT_NEAR(told.at("parameters").at("factor").at("value").number(), 1.0 / 9.80665, 1e-12);
  EXPECT_EQ(json.at("gain").at("from").string(), "extended_study");
  const auto extended = study::read_study(at("out/extended.toml"), {study.file.parent_path()});
  EXPECT_NEAR(extended.sensors[1].gain, 1.0 / 9.80665, 1e-9);
  EXPECT_EQ(extended.sensors[0].gain, 1.0);
  EXPECT_NE(left("extended.toml").find("g taken for m/s^2"), std::string::npos);
  EXPECT_LT(one.gain.fit_after, 0.02);
}

// All records are accelerations: a property of the file, of the sensor that was held out, too.
TEST_F(Told, AQuantityIsSaidEverywhereAndTheExtendedStudyAgrees) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of(
      {cause("sensor_quantity", {"s1", "s2", "s3"}, {}, "acceleration taken for displacement")},
      "\"sensor_quantity\", \"sensor_gain\"");
  const auto one = diagnosed_of(study);
  ASSERT_EQ(one.result.verdict, Verdict::named) << show::diagnosis_table(one);
  EXPECT_NE(show::diagnosis_table(one).find("acceleration taken for displacement"),
            std::string::npos);
  EXPECT_LT(one.gain.fit_after, 0.02);
  EXPECT_LT(one.gain.held_out_after, 0.02);
  EXPECT_EQ(one.gain.from, steps::GainFrom::extended_study);
  // The file is read as what it is now.
  const auto extended = study::read_study(at("out/extended.toml"), {study.file.parent_path()});
  for (const auto& sensor : extended.sensors) EXPECT_EQ(sensor.quantity, "acceleration");
  EXPECT_EQ(extended.identification->unit, "m/s^2");
  const auto again = diagnosed_of(extended);
  EXPECT_EQ(again.result.verdict, Verdict::no_discrepancy) << show::diagnosis_table(again);
  EXPECT_LT(again.gain.fit_before, 0.02);
}

TEST_F(Told, ACauseThatNoStudyExpressesHasAGainWithoutAnotherSolution) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of({cause("sensor_crosstalk", {"s1", "s2"}, {{"share", 0.2}})},
                              "\"sensor_crosstalk\", \"sensor_gain\", \"sensor_position\"");
  app::QuietRun quiet(study, at("out"));
  const auto one = steps::diagnosed(study, quiet.run(),
                                    [](const study::Study&, stage::Work&) -> stage::Solution {
                                      ADD_FAILURE() << "an unchanged study was solved again";
                                      throw NumericalFailure("not to be solved");
                                    });
  ASSERT_FALSE(one.result.best.causes.empty());
  ASSERT_EQ(one.result.best.causes.front().effect, "sensor_crosstalk")
      << show::diagnosis_table(one);
  EXPECT_EQ(one.gain.from, steps::GainFrom::fitted_model);
  EXPECT_FALSE(one.gain.pays.has_value());
  EXPECT_TRUE(one.gain.fitted_pays.value_or(false));
  EXPECT_GT(one.gain.fit_before, 0.05);
  EXPECT_LT(one.gain.fit_after, 0.02);
  const auto json = io::Json(show::diagnosis_json(one));
  EXPECT_EQ(json.at("gain").at("from").string(), "fitted_model");
  EXPECT_EQ(json.at("not_in_extended_study").array().size(), 1U);
  EXPECT_EQ(json.at("gain").at("fitted").at("sensors").array().size(), 2U);
  EXPECT_EQ(json.at("gain").at("held_out_channels").array().front().string(), "s3");
  EXPECT_TRUE(std::get<bool>(json.at("gain").at("pays").value()));
  const auto text = show::diagnosis_table(one);
  EXPECT_NE(text.find("reduced model"), std::string::npos) << text;
  EXPECT_NE(text.find("by it the causes pay\n"), std::string::npos) << text;
  auto in_vain = one;
  in_vain.gain.fitted_pays = false;
  const auto told = io::Json(show::diagnosis_json(in_vain));
  EXPECT_FALSE(std::get<bool>(told.at("gain").at("pays").value()));
  EXPECT_NE(show::diagnosis_table(in_vain).find("by it the causes do not pay\n"),
            std::string::npos);
  // Causes of modes are judged by frequencies and shapes, too, which that model does not give.
  in_vain.result.modes = {diagnosis::ModeTold{}};
  const auto of_modes = io::Json(show::diagnosis_json(in_vain));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(of_modes.at("gain").at("pays").value()));
}

TEST_F(Told, AnExtendedStudyThatCannotBeSolvedCostsNothingElse) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of({cause("point_mass", {}, {{"mass", 0.2}, {"u", 0.1}, {"v", -0.05}})},
                              "\"point_mass\"");
  app::QuietRun quiet(study, at("out"));
  const auto one = steps::diagnosed(study, quiet.run(),
                                    [](const study::Study&, stage::Work&) -> stage::Solution {
                                      throw NumericalFailure("the matrix is not positive definite");
                                    });
  show::leave_diagnosis(study, one, quiet.run(), false);
  const auto json = io::parse_json(left("diagnosis.json"));
  EXPECT_EQ(json.at("causes").array().front().at("effect").string(), "point_mass");
  EXPECT_NE(left("diagnosis.json").find("cannot be solved: the matrix is not positive definite"),
            std::string::npos);
  EXPECT_NE(left("extended.toml").find("# This study could not be solved"), std::string::npos);
  EXPECT_EQ(one.gain.from, steps::GainFrom::fitted_model);
  EXPECT_LT(one.gain.held_out_after, 0.3 * one.gain.held_out_before);
  EXPECT_TRUE(std::get<bool>(json.at("gain").at("pays").value()));
  const auto text = show::diagnosis_table(one);  // a study could express the cause
  EXPECT_NE(text.find("by it the causes pay\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("does not express"), std::string::npos) << text;
}

// The structure of a study, solved, and its measured responses, not compared yet.
std::pair<steps::Compared, steps::MeasuredFrfs> to_compare(const study::Study& study,
                                                           stage::Work& work) {
  steps::Compared one;
  one.before = stage::solved(stage::with_modes_for_diagnosis(study), work);
  return {std::move(one), steps::measured_frfs(study, work)};
}

// One record without a unit takes the scale from none that states its own.
TEST_F(Told, ARecordWithoutAUnitLeavesTheScaleOfTheOthers) {
  EVERY_FOURTH_LANDING();
  const auto study = study_of({}, "\"sensor_gain\"");
  app::QuietRun quiet(study, at("out"));
  auto& work = quiet.run();
  auto ready = to_compare(study, work);
  auto& one = ready.first;
  auto& measured = ready.second;
  for (auto& value : measured.all.value) value *= 2.0;
  const auto level = [&](const std::vector<std::string>& units) {
    auto records = measured;
    for (std::size_t i = 0; i < units.size(); ++i) records.all.outputs[i].unit = units[i];
    auto some = one;
    const bool scaled = steps::compare_responses(study, records, some, work).scaled;
    EXPECT_EQ(scaled, units != std::vector<std::string>(3));
    return some.comparison.responses.level;
  };
  EXPECT_NEAR(level({"m", "", "m"}), 2.0, 0.02);
  EXPECT_NE(quiet.said().find("s2: no unit is stated"), std::string::npos) << quiet.said();
  EXPECT_NEAR(level({"", "", ""}), 1.0, 0.02);
}

// What is divided by the scale of the simulation is divided with its variances, of all kinds: the
// part of them that is noise tells whether the structure is linear.
TEST_F(Told, ANewScaleLeavesThePartThatIsNoise) {
  const auto study = study_of({}, "\"sensor_gain\"");
  app::QuietRun quiet(study, at("out"));
  auto& work = quiet.run();
  auto ready = to_compare(study, work);
  auto& one = ready.first;
  auto& measured = ready.second;
  for (auto& value : measured.all.value) value *= 100.0;
  for (auto& variance : measured.all.variance) variance *= 1e4;
  for (const auto& variance : measured.all.variance) {
    measured.all.noise_variance.emplace_back(0.8 * variance);
  }
  for (auto& channel : measured.all.outputs) channel.unit.clear();
  ASSERT_FALSE(steps::compare_responses(study, measured, one, work).scaled);
  for (const auto* set : {&one.measured.all, &one.seen}) {
    for (std::size_t k = 0; k < set->value.size(); ++k) {
      EXPECT_LT((set->noise_variance[k] - 0.8 * set->variance[k]).norm(),
                1e-12 * set->variance[k].norm());
    }
  }
}

// As exporters write them: a line of full coherence has no variance, one that nobody excited no
// response either.
TEST_F(Told, AVarianceOfZeroIsThatOfTheNeighbours) {
  const auto study = study_of({}, "\"sensor_gain\"");
  app::QuietRun quiet(study, at("out"));
  auto& work = quiet.run();
  const auto measured = steps::measured_frfs(study, work);
  auto zeros = measured;
  zeros.all.variance[50](0, 1) = 0.0;
  zeros.all.variance[70](1, 2) = 0.0;
  zeros.all.value[70](1, 2) = 0.0;
  const auto plan = steps::plan_of(study);
  const auto all = steps::within_band(measured, study, plan, 500.0, work).all;
  const auto some = steps::within_band(zeros, study, plan, 500.0, work).all;
  ASSERT_EQ(some.value.size(), all.value.size());
  EXPECT_TRUE(std::isnan(some.value[70](1, 2).real()));
  EXPECT_EQ(some.value[50](0, 1), all.value[50](0, 1));
  double least = HUGE_VAL, most = 0.0;
  for (std::size_t k = 40; k <= 60; ++k) {
    least = std::min(least, all.variance[k](0, 1));
    most = std::max(most, all.variance[k](0, 1));
  }
  EXPECT_GT(some.variance[50](0, 1), least);
  EXPECT_LT(some.variance[50](0, 1), most);
  for (std::size_t k = 0; k < all.value.size(); ++k) {
    if (k != 50 && k != 70) {
      EXPECT_EQ(some.variance[k], all.variance[k]) << k;
    }
  }
}

/// Keeps the notes.
class Noted : public stage::Work {
 public:
  void note(std::string_view line) override { said += std::string(line) + "\n"; }
  std::string said;
};

// Each is counted for itself: lines of full coherence, and lines that nobody excited, single or all
// of a response.
TEST_F(Told, WhatWasNotMeasuredIsNotAVarianceOfTheNeighbours) {
  const auto study = study_of({}, "\"sensor_gain\"");
  const auto within = [&](const std::vector<std::size_t>& coherent, bool has_unmeasured) {
    Noted work;
    auto measured = steps::measured_frfs(study, work);
    for (const auto k : coherent) measured.all.variance[k](0, 1) = 0.0;
    for (std::size_t k = 0; k < measured.all.value.size() && has_unmeasured; ++k) {
      measured.all.value[k](1, 2) = 0.0;
      measured.all.variance[k](1, 2) = 0.0;
    }
    const auto all = steps::within_band(measured, study, steps::plan_of(study), 500.0, work).all;
    return std::pair(all, work.said);
  };
  const auto [all, said] = within({50, 60}, true);
  const auto lines = std::to_string(all.value.size());
  EXPECT_NE(said.find(lines + " measured values are 0"), std::string::npos) << said;
  EXPECT_NE(said.find("2 of the stated variances are 0"), std::string::npos) << said;
  for (const auto& line : all.value) EXPECT_TRUE(std::isnan(line(1, 2).real()));
  EXPECT_EQ(within({}, true).second.find("of the stated variances"), std::string::npos);
  EXPECT_EQ(within({50}, false).second.find("measured values are 0"), std::string::npos);
}

TEST_F(Told, CtrlCIsNoNote) {
  const auto study = study_of({cause("point_mass", {}, {{"mass", 0.2}, {"u", 0.1}, {"v", -0.05}})},
                              "\"point_mass\"");
  app::QuietRun quiet(study, at("out"));
  EXPECT_THROW(
      static_cast<void>(steps::diagnosed(study, quiet.run(),
                                         [](const study::Study&, stage::Work&) -> stage::Solution {
                                           throw Interrupted("Ctrl-C");
                                         })),
      Interrupted);
}

}  // namespace
}  // namespace chladni::steps
