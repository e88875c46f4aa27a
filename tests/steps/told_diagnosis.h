// A study whose responses are those of its own model with a cause in it, and its diagnosis as it is
// told.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "diagnosis/hypothesis.h"
#include "io/frf_file.h"
#include "show/diagnosis.h"
#include "stage/diagnosis_structure.h"
#include "steps/diagnosis.h"
#include "tests/app/quiet_run.h"

namespace chladni::steps {

using diagnosis::Cause;
using diagnosis::Verdict;

inline const std::string kToldStudy =
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

inline Cause cause(const std::string& effect, const std::vector<std::string>& channels,
                   const std::vector<std::pair<std::string, double>>& numbers,
                   const std::string& option = "") {
  Cause made;
  made.effect = effect;
  made.channels = channels;
  made.option = option;
  for (const auto& [name, value] : numbers) made.parameters.push_back({name, "1", value, 0.0});
  return made;
}

inline constexpr const char* kThree = "\"youngs_modulus\", \"sensor_gain\", \"point_mass\"";
class Told : public testing::Test {
 protected:
  // Writes study and data into the folder.
  // @param scatter  by which the modes of the data are off those of the study, relative
  study::Study study_of(const std::vector<Cause>& causes, const std::string& effects,
                        double scatter = 0.0) {
    std::string text = kToldStudy;
    text.replace(text.find("EFFECTS"), 7, effects);
    const auto file = folder_.path() / "study.toml";
    std::ofstream(file) << text;
    write_responses(causes, study::parse_study(text, file), scatter);
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
  void write_responses(const std::vector<Cause>& causes, const study::Study& study,
                       double scatter) const {
    const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(120, 30.0, 400.0);
    modal::FrfSet set;
    for (const auto& one : study.sensors) set.outputs.emplace_back().name = one.name;
    for (const auto& one : study.actuators) set.inputs.emplace_back().name = one.name;
    set.frequency_hz = lines;
    auto body = structure(study);
    for (Eigen::Index k = 0; k < body.mode_count() && scatter > 0.0; ++k) {
      const auto wave = [&](double i) { return std::sin(2.4 * static_cast<double>(k) + 1.9 * i); };
      body.frequency_hz(k) *= 1.0 + scatter * wave(0.0);
      for (Eigen::Index i = 0; i < body.output_count(); ++i)
        body.outputs.shapes(i, k) *= 1.0 + 3.0 * scatter * wave(static_cast<double>(i) + 1.0);
    }
    set.value = diagnosis::predicted(body, causes, lines);
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

}  // namespace chladni::steps
