// chladni experiment: signals that keep the limits of the rig, read back and played.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <variant>

#include "app/command.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/json.h"
#include "io/time_file.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

class Experiment : public testing::Test {
 protected:
  [[nodiscard]] std::string text_of(const std::string& name) const {
    return read_whole(fs::path(CHLADNI_SOURCE_DIR) / "models" / "recordings" / (name + ".toml"));
  }
  static std::string exchanged(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  [[nodiscard]] io::Json design(const std::string& text, std::string* shown = nullptr) const {
    const auto study = study::parse_study(text, folder_.path() / "study.toml");
    QuietRun quiet(study, folder_.path() / "out");
    experiment_command.run(study, quiet.run());
    if (shown != nullptr) *shown = quiet.shown();
    return io::parse_json(read_whole(folder_.path() / "out" / "experiment.json"));
  }

  TestFolder folder_{"experiment"};
};

TEST_F(Experiment, LeavesSignalsThatAreReadBackAndKeepTheLimits) {
  std::string shown;
  const auto text = text_of("experiment");
  const auto json = design(text, &shown);
  EXPECT_EQ(shown.find(json.at("verdict").string()),
            shown.find_first_not_of(" \n", shown.find(json.at("verdict").string())));
  EXPECT_NE(shown.find("of measuring give"), std::string::npos) << shown;
  const auto out = folder_.path() / "out";
  const io::TimeOptions options{.actuator_names = {"coil1", "coil2"}};
  const auto csv = io::read_time(out / "excitation.csv", options).data;
  const auto mat = io::read_time(out / "excitation.mat", options).data;
  const auto samples = static_cast<Eigen::Index>(json.at("samples").number());
  ASSERT_EQ(csv.records.size(), 8U);  // 4 realisations of 2 experiments
  ASSERT_EQ(mat.records.size(), 8U);
  EXPECT_EQ(csv.period, samples);
  double largest = 0.0;
  for (std::size_t r = 0; r < 8; ++r) {
    EXPECT_EQ(csv.records[r].inputs.rows(), samples);
    EXPECT_LT((csv.records[r].inputs - mat.records[r].inputs).norm(),
              1e-12 * csv.records[r].inputs.norm());
    largest = std::max(largest, csv.records[r].inputs.cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(json.at("unit").string(), "V");
  EXPECT_LE(0.3 * largest, 2.0);  // N
  EXPECT_LE(largest, 10.0);       // V
  EXPECT_NEAR(json.at("wav_full_scale").number(), largest, 1e-9 * largest);
  // The first period of the file is the one that settles and fades in.
  const auto ramp = static_cast<std::size_t>(json.at("ramp_samples").number());
  const auto periods =
      static_cast<std::size_t>(json.at("settle_periods").number() + json.at("periods").number());
  EXPECT_EQ(fs::file_size(out / "excitation_r1_e1.wav"),
            44 + 2 * 4 * (periods * static_cast<std::size_t>(samples) + ramp));
}

// `simulate` plays the file on the simulated rig, whose amplifiers make forces of its volts.
TEST_F(Experiment, ItsSignalsArePlayedWithinTheStroke) {
  const auto text = exchanged(text_of("experiment"), "stroke = \"0.5 mm\"",
                              "stroke = \"0.02 mm\"\nrealisations = 2");
  (void)design(text);
  const auto played = exchanged(text, "noise = \"1 um\"",
                                "noise = \"1 um\"\nexcitation = \"out/excitation.csv\"\n"
                                "periods = 2\nwarm_up = 1\nleaves = \"time\"");
  const auto study = study::parse_study(played, folder_.path() / "study.toml");
  QuietRun quiet(study, folder_.path() / "played");
  simulate_command.run(study, quiet.run());
  const auto data =
      io::read_time(folder_.path() / "played" / "time_data.csv",
                    {.sensor_names = {"tip", "middle"}, .actuator_names = {"coil1", "coil2"}})
          .data;
  ASSERT_EQ(data.records.size(), 4U);
  double stroke = 0.0;
  for (const auto& record : data.records) {
    stroke = std::max(stroke, record.outputs.cwiseAbs().maxCoeff());
  }
  EXPECT_LE(stroke, 0.02e-3);
  EXPECT_GT(stroke, 0.7 * 0.8 * 0.02e-3);
}

// The table and the file say the same of each actuator.
TEST_F(Experiment, TellsWhatBoundsTheForces) {
  const auto bounded_by = [&](const std::string& limit) {
    std::string shown;
    const auto json =
        design(exchanged(text_of("experiment"), "voltage = \"10 V\"\n", limit), &shown);
    std::string last;
    for (const auto& force : json.at("forces").array()) {
      last = force.at("limited_by").string();
      std::string row = shown.substr(shown.find("\n" + force.at("actuator").string() + " "));
      row.resize(row.find('\n', 1));
      EXPECT_EQ(row.substr(row.find_last_of(' ') + 1), last);
    }
    return last;
  };
  EXPECT_EQ(bounded_by("voltage = \"1 V\"\n"), "voltage");
  EXPECT_EQ(bounded_by("voltage = \"10 V\"\n"), "force");
}

TEST_F(Experiment, TellsWhereToHit) {
  std::string shown;
  const auto json = design(text_of("hammer_design"), &shown);
  EXPECT_NE(shown.find("blows of 50 N"), std::string::npos) << shown;
  EXPECT_GE(json.at("points").array().size(), 1U);
  EXPECT_GE(json.at("hits").number(), 3.0);
  for (const auto& mode : json.at("modes").array()) {
    if (!std::get<bool>(mode.at("reached").value())) continue;
    EXPECT_LE(mode.at("damping_std").number(), 0.02 * mode.at("damping_ratio").number());
  }
  EXPECT_TRUE(fs::exists(folder_.path() / "out" / "hammer_points.csv"));
}

// The signals were designed, and then could not be written.
TEST_F(Experiment, RefusesNamesThatTheTableOfSignalsCannotHoldBeforeItSolves) {
  const auto named = exchanged(text_of("experiment"), "\"coil1\"", "\"coil1 [N]\"");
  const auto said = refusal_of([&] {
    return design(exchanged(named, "\"20 mm\", order", "\"1 um\", order"));  // cannot be solved
  });
  EXPECT_NE(said.find("CSV cannot hold the channel name"), std::string::npos) << said;
}

TEST_F(Experiment, RefusesStudiesThatDoNotSayEnough) {
  const auto text = text_of("experiment");
  const auto at = text.find("[design]");
  EXPECT_NE(refusal_of([&] { return design(text.substr(0, at)); }).find("no [design]"),
            std::string::npos);
  const auto limits =
      exchanged(text, "force = \"2 N\"\nstroke = \"0.5 mm\"\nvoltage = \"10 V\"\n", "");
  EXPECT_NE(refusal_of([&] { return design(limits); }).find("what the rig bears"),
            std::string::npos);
  const auto volts = exchanged(text, "force_per_volt = \"0.3 N/V\"\n", "");
  EXPECT_NE(refusal_of([&] { return design(volts); }).find("force_per_volt"), std::string::npos);
  const auto quiet = exchanged(text, "noise = \"1 um\"\n", "");
  EXPECT_NE(refusal_of([&] { return design(quiet); }).find("no noise"), std::string::npos);
}

}  // namespace
}  // namespace chladni::app
