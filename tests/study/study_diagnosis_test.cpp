// [diagnosis] of a study, its tolerances, and what stands between channels and records.
#include <gtest/gtest.h>

#include <complex>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "base/error.h"
#include "stage/channel_paths.h"
#include "study/study.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;

const std::string kBody = R"(
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
[[sensor]]
name = "s1"
at = ["-250 mm", "250 mm"]
direction = "z"
gain = 1.02
delay = "12 us"
low_pass = "3 kHz"
[[sensor]]
name = "s2"
at = ["250 mm", "250 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["-200 mm", "200 mm"]
direction = "z"
gain = "50 %"
)";

study::Study parsed(const std::string& more) {
  return study::parse_study(kBody + more, "bench/study.toml");
}

std::string refusal(const std::string& more) {
  return refusal_of([&] { return parsed(more); });
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

void expect_equal(const diagnosis::Tolerances& a, const diagnosis::Tolerances& b) {
  EXPECT_DOUBLE_EQ(a.gain, b.gain);
  EXPECT_DOUBLE_EQ(a.position, b.position);
  EXPECT_DOUBLE_EQ(a.delay, b.delay);
  EXPECT_DOUBLE_EQ(a.modulus, b.modulus);
  EXPECT_DOUBLE_EQ(a.density, b.density);
  EXPECT_DOUBLE_EQ(a.thickness, b.thickness);
  EXPECT_DOUBLE_EQ(a.orthotropy, b.orthotropy);
  EXPECT_DOUBLE_EQ(a.frequency, b.frequency);
  EXPECT_DOUBLE_EQ(a.damping, b.damping);
  EXPECT_DOUBLE_EQ(a.response, b.response);
  EXPECT_DOUBLE_EQ(a.residual, b.residual);
  EXPECT_DOUBLE_EQ(a.scale, b.scale);
  EXPECT_DOUBLE_EQ(a.mass, b.mass);
  EXPECT_DOUBLE_EQ(a.loaded_damping, b.loaded_damping);
}

TEST(StudyDiagnosis, IsReadInSi) {
  const auto study = parsed(R"([diagnosis]
band = ["20 Hz", "0.9 kHz"]
hold_out_band = ["700 Hz", "900 Hz"]
tolerances = { position = "1 mm", gain = "1 %", delay = "2 us", damping = 0.3, loaded_damping = 0 }
effects = ["point_mass", "sensor_gain"]
most_causes = 2
least_evidence = 10
rival_within = 4
lines = 200
)");
  ASSERT_TRUE(study.diagnosis);
  const auto& plan = *study.diagnosis;
  EXPECT_DOUBLE_EQ(plan.low_hz, 20.0);
  EXPECT_DOUBLE_EQ(plan.high_hz, 900.0);
  EXPECT_DOUBLE_EQ(plan.hold_out_low_hz, 700.0);
  EXPECT_DOUBLE_EQ(plan.hold_out_high_hz, 900.0);
  EXPECT_EQ(plan.effects, (std::vector<std::string>{"point_mass", "sensor_gain"}));
  EXPECT_EQ(plan.most_causes, 2);
  EXPECT_DOUBLE_EQ(plan.least_evidence, 10.0);
  EXPECT_DOUBLE_EQ(plan.rival_within, 4.0);
  EXPECT_EQ(plan.lines, 200);
  diagnosis::Tolerances expected;
  expected.position = 1e-3;
  expected.gain = 0.01;
  expected.delay = 2e-6;
  expected.damping = 0.3;
  expected.loaded_damping = 0.0;
  expect_equal(plan.tolerances, expected);
}

TEST(StudyDiagnosis, WithoutKeysIsTheUsual) {
  const auto plan = *parsed("[diagnosis]\n").diagnosis;
  EXPECT_EQ(plan.high_hz, 0.0);
  EXPECT_EQ(plan.most_causes, 3);
  EXPECT_TRUE(plan.effects.empty());
  expect_equal(plan.tolerances, {});
  EXPECT_FALSE(parsed("").diagnosis);
}

TEST(StudyDiagnosis, TheFileOfTolerancesShowsTheUsualOnes) {
  const fs::path models = fs::path(CHLADNI_SOURCE_DIR) / "models";
  expect_equal(study::read_tolerances(models / "tolerances.toml"), {});
}

TEST(StudyDiagnosis, TolerancesMayHaveAFileBesideTheStudy) {
  const app::TestFolder folder("tolerances");
  write(folder.path() / "mine.toml", "gain = \"2 %\"\n");
  const auto file = folder.path() / "study.toml";
  const auto text = kBody + "[diagnosis]\ntolerances = \"mine.toml\"\n";
  const auto plan = *study::parse_study(text, file).diagnosis;
  EXPECT_DOUBLE_EQ(plan.tolerances.gain, 0.02);
  EXPECT_DOUBLE_EQ(plan.tolerances.position, diagnosis::Tolerances{}.position);
  EXPECT_EQ(plan.tolerances_file.filename(), "mine.toml");

  write(folder.path() / "mine.toml", "\ngain = \"2 mm\"\npositon = \"1 mm\"\ndelay = 3\n");
  try {
    static_cast<void>(study::parse_study(text, file));
    FAIL() << "wrong tolerances were taken";
  } catch (const InvalidInput& e) {
    const std::string said = e.what();
    EXPECT_NE(said.find("mine.toml:2:8"), std::string::npos) << said;
    EXPECT_NE(said.find("in the file of tolerances; did you mean \"position\""), std::string::npos)
        << said;
    EXPECT_NE(said.find("a time such as"), std::string::npos) << said;
    EXPECT_NE(said.find("diagnosis.tolerances"), std::string::npos) << said;
  }
  EXPECT_THROW(static_cast<void>(study::read_tolerances(folder.path() / "none.toml")),
               InvalidInput);
  EXPECT_THROW(static_cast<void>(study::read_tolerances(folder.path())), InvalidInput);
}

TEST(StudyDiagnosisRefuses, WhatCannotBe) {
  const auto says = [](const std::string& more, const std::string& part) {
    const auto said = refusal("[diagnosis]\n" + more + "\n");
    EXPECT_NE(said.find(part), std::string::npos) << more << ": " << said;
  };
  says("band = [\"900 Hz\", \"20 Hz\"]", "its end is not above its start");
  says("hold_out_band = [\"900 Hz\", \"20 Hz\"]", "diagnosis.hold_out_band");
  says("band = [\"20 Hz\"]", "an array of 2");
  says("effects = [\"point_mas\"]", "did you mean \"point_mass\"");
  says("most_causes = 0", "from 1 to 10");
  says("tolerances = \"../elsewhere.toml\"", "leaves the study's folder");
  says("tolerances = { gain = \"-1 %\" }", "0 or more");
  says("tolerances = { gains = 0.1 }", "did you mean \"gain\"");
  says("bands = 3", "did you mean \"band\"");
}

TEST(ChannelPaths, AreReadWithTheChannels) {
  const auto study = parsed("");
  EXPECT_DOUBLE_EQ(study.sensors[0].gain, 1.02);
  EXPECT_DOUBLE_EQ(study.sensors[0].delay, 12e-6);
  EXPECT_DOUBLE_EQ(study.sensors[0].low_pass_hz, 3000.0);
  EXPECT_DOUBLE_EQ(study.sensors[1].gain, 1.0);
  EXPECT_DOUBLE_EQ(study.actuators[0].gain, 0.5);
  EXPECT_TRUE(stage::has_paths(study));
  EXPECT_NE(refusal("[[sensor]]\nname = \"x\"\nat = [\"0 mm\", \"0 mm\"]\ndirection = \"z\"\n"
                    "gain = -1\n")
                .find("more than 0"),
            std::string::npos);
}

modal::FrfSet responses() {
  modal::FrfSet set;
  for (const auto* name : {"s2", "s1", "stranger"}) set.outputs.emplace_back().name = name;
  set.inputs.emplace_back().name = "a1";
  set.frequency_hz = Eigen::Vector3d(0.0, 100.0, 3000.0);
  set.value.assign(3, Eigen::MatrixXcd::Constant(3, 1, std::complex<double>(2.0, 1.0)));
  set.variance.assign(3, Eigen::MatrixXd::Constant(3, 1, 0.25));
  return set;
}

TEST(ChannelPaths, AreGainDelayAndLowPass) {
  const auto study = parsed("");
  const auto at = stage::path(study.sensors[0], 3000.0);
  EXPECT_NEAR(std::abs(at), 1.02 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(std::arg(at), -2.0 * std::numbers::pi * 3000.0 * 12e-6 - std::numbers::pi / 4.0,
              1e-12);
  const auto set = responses();
  const auto record = stage::recorded(study, set);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto own = stage::path(study.sensors[0], set.frequency_hz(static_cast<Eigen::Index>(k)));
    EXPECT_EQ(record.value[k](0, 0), 0.5 * set.value[k](0, 0));
    EXPECT_LT(std::abs(record.value[k](1, 0) - 0.5 * own * set.value[k](1, 0)), 1e-12);
    EXPECT_EQ(record.value[k](2, 0), 0.5 * set.value[k](2, 0));
    EXPECT_NEAR(record.variance[k](1, 0), 0.25 * 0.25 * std::norm(own), 1e-12);
  }
}

TEST(ChannelPaths, GoForthAndBack) {
  const auto study = parsed("");
  const auto set = responses();
  const auto back = stage::without_paths(study, stage::recorded(study, set));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT((back.value[k] - set.value[k]).norm(), 1e-12);
    EXPECT_LT((back.variance[k] - set.variance[k]).norm(), 1e-12);
  }
}

TEST(StudyDiagnosis, LearnsTheLevelsUnlessTheyAreKnown) {
  EXPECT_EQ(parsed("[diagnosis]\n").diagnosis->levels, "learned");
  EXPECT_EQ(parsed("[diagnosis]\nlevels = \"known\"\n").diagnosis->levels, "known");
  EXPECT_NE(refusal("[diagnosis]\nlevels = \"guessed\"\n"), "");
}

TEST(StudyMeasurement, HasModesInAFileOrANumberOfThoseOfTheTruth) {
  const auto study = parsed("[measurement]\nmodes = \"modes.csv\"\n");
  EXPECT_EQ(study.measurement->modes_file.filename(), "modes.csv");
  EXPECT_EQ(study.measurement->modes, 0);
  ASSERT_EQ(study.files.size(), 1U);
  EXPECT_EQ(study.files.front().key, "measurement.modes");
  const auto counted = parsed("[measurement]\ntruth = \"real.toml\"\nmodes = 7\n");
  EXPECT_EQ(counted.measurement->modes, 7);
  EXPECT_TRUE(counted.measurement->modes_file.empty());
}

TEST(StudyMeasurement, HasAReferenceBesideModesOnly) {
  const auto study = parsed("[measurement]\nmodes = \"after.csv\"\nreference = \"before.csv\"\n");
  EXPECT_EQ(study.measurement->reference.filename(), "before.csv");
  ASSERT_EQ(study.files.size(), 2U);
  EXPECT_EQ(study.files.back().key, "measurement.reference");
  const auto alone = refusal("[measurement]\nreference = \"before.csv\"\n");
  EXPECT_NE(alone.find("a reference without modes"), std::string::npos) << alone;
}

TEST(StudyMeasurement, RefusesModesOfAFileBesideResponsesAndANumberAlone) {
  const auto both = refusal("[measurement]\nmodes = \"modes.csv\"\nfrf = \"measured.uff\"\n");
  EXPECT_NE(both.find("modes in a file and frf"), std::string::npos) << both;
  const auto alone = refusal("[measurement]\nmodes = 7\n");
  EXPECT_NE(alone.find("modes = \"modes.csv\""), std::string::npos) << alone;
  const auto outside = refusal("[measurement]\nmodes = \"../modes.csv\"\n");
  EXPECT_NE(outside.find("measurement.modes"), std::string::npos) << outside;
}

}  // namespace
}  // namespace chladni::study
