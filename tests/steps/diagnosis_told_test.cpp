// How a diagnosis is told: text, JSON, report and extended study of one that is known. The
// responses are the study's own model's with a cause in it: what is found is not the question here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "diagnosis/hypothesis.h"
#include "io/frf_file.h"
#include "rotation/turn.h"
#include "show/diagnosis.h"
#include "stage/diagnosis_structure.h"
#include "steps/diagnosis.h"
#include "tests/app/quiet_run.h"

namespace chladni::steps {
namespace {

using diagnosis::Cause;
using diagnosis::Verdict;

const std::string kToldStudy =
    R"(geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { damping_ratio = 0.01 }
[measurement]
frf = "measured.csv"
hold_out = ["s3"]
[identification]
unit = "m"
[diagnosis]
least_evidence = 9
lines = 120
effects = [EFFECTS]
[[sensor]]
name = "s1"
at = ["-250 mm", "150 mm"]
direction = "z"
[[sensor]]
name = "s2"
at = ["110 mm", "40 mm"]
direction = "z"
[[sensor]]
name = "s3"
at = ["240 mm", "-170 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["-170 mm", "-120 mm"]
direction = "z"
[[actuator]]
name = "a2"
at = ["230 mm", "0 mm"]
direction = "z"
[[actuator]]
name = "a3"
at = ["20 mm", "160 mm"]
direction = "z"
)";

Cause cause(const std::string& effect, const std::vector<std::string>& channels,
            const std::vector<std::pair<std::string, double>>& numbers,
            const std::string& option = "") {
  Cause made;
  made.effect = effect;
  made.channels = channels;
  made.option = option;
  for (const auto& [name, value] : numbers) made.parameters.push_back({name, "1", value, 0.0});
  return made;
}

constexpr const char* kThree = "\"youngs_modulus\", \"sensor_gain\", \"point_mass\"";
class Told : public testing::Test {
 protected:
  // Writes study and data into the folder.
  study::Study study_of(const std::vector<Cause>& causes, const std::string& effects) {
    std::string text = kToldStudy;
    text.replace(text.find("EFFECTS"), 7, effects);
    const auto file = folder_.path() / "study.toml";
    std::ofstream(file) << text;
    write_responses(causes, study::parse_study(text, file));
    return study::read_study(file);
  }

  // The same without a part of its text; nothing is held out.
  study::Study changed(const study::Study& study, const std::string& from, const std::string& to) {
    std::string text = study.text;
    for (const auto& [was, is] : {std::pair{from, to}, {"hold_out = [\"s3\"]\n", ""}}) {
      EXPECT_NE(text.find(was), std::string::npos) << was;
      text.replace(text.find(was), was.size(), is);
    }
    std::ofstream(study.file) << text;
    return study::read_study(study.file);
  }

  steps::Diagnosed diagnosed_of(const study::Study& study) {
    app::QuietRun quiet(study, folder_.path() / "out");
    auto result = steps::diagnosed(study, quiet.run());
    show::leave_diagnosis(study, result, quiet.run(), false);
    said_ = quiet.said();
    return result;
  }

  std::string left(const char* name) const {
    std::ifstream file(folder_.path() / "out" / name);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  std::filesystem::path at(const char* name) const { return folder_.path() / name; }

  // The modulus is that of the data, which the text tells and the extended study has.
  void expect_calibrated(const study::Study& study, const steps::Diagnosed& one, double by) const {
    ASSERT_TRUE(one.result.constants.size() == 1U && one.result.constants.front().determined);
    const auto& modulus = one.result.constants.front();
    EXPECT_NEAR(modulus.value, (1.0 + by) * 70e9, 0.01 * 70e9);
    EXPECT_LT(modulus.std, 0.07 * modulus.value);  // the error of so coarse a mesh
    EXPECT_NE(show::diagnosis_table(one).find("material.youngs_modulus"), std::string::npos);
    EXPECT_LT(one.gain.fit_after, 0.5 * one.gain.fit_before);
    const auto extended = study::read_study(at("out/extended.toml"), {study.file.parent_path()});
    const auto& constants = extended.materials.front().constants;
    const auto written =
        std::ranges::find(constants, "youngs_modulus", &std::pair<std::string, double>::first);
    ASSERT_NE(written, constants.end());
    EXPECT_NEAR(written->second, modulus.value, 1e-4 * modulus.value);
  }

  std::string said_;

 private:
  // With 0.5 % noise, 30 to 400 Hz.
  void write_responses(const std::vector<Cause>& causes, const study::Study& study) const {
    const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(120, 30.0, 400.0);
    modal::FrfSet set;
    for (const auto& one : study.sensors) set.outputs.emplace_back().name = one.name;
    for (const auto& one : study.actuators) set.inputs.emplace_back().name = one.name;
    set.frequency_hz = lines;
    set.value = diagnosis::predicted(structure(study), causes, lines);
    std::mt19937 dice(11);
    std::normal_distribution<double> normal;
    for (auto& value : set.value) {
      const Eigen::MatrixXd deviation = 0.005 * value.cwiseAbs();
      set.variance.emplace_back(deviation.cwiseAbs2());
      for (Eigen::Index e = 0; e < value.size(); ++e) {
        value(e) +=
            std::sqrt(0.5) * deviation(e) * std::complex<double>(normal(dice), normal(dice));
      }
    }
    (void)io::write_frf(folder_.path() / "measured.csv", set);
  }

  // Kept between tests: it is the same body.
  const diagnosis::Structure& structure(const study::Study& study) const {
    static const diagnosis::Structure made = [&] {
      const study::Study with_modes = stage::with_modes_for_diagnosis(study);
      app::QuietRun quiet(with_modes, folder_.path() / "made");
      return stage::structure_of(study, stage::solved(with_modes, quiet.run()));
    }();
    return made;
  }

  app::TestFolder folder_{"told"};
};

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
  EXPECT_GT(one.gain.fit_before, 0.05);
  EXPECT_LT(one.gain.fit_after, 0.02);
  const auto json = io::Json(show::diagnosis_json(one));
  EXPECT_EQ(json.at("gain").at("from").string(), "fitted_model");
  EXPECT_EQ(json.at("not_in_extended_study").array().size(), 1U);
  EXPECT_EQ(json.at("gain").at("fitted").at("sensors").array().size(), 2U);
  EXPECT_EQ(json.at("gain").at("held_out_channels").array().front().string(), "s3");
  EXPECT_NE(show::diagnosis_table(one).find("reduced model"), std::string::npos);
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
}

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
