// What a fit of recordings says of recordings that it has not seen.
#include <gtest/gtest.h>

#include <filesystem>

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

constexpr const char* kFirst = "time = \"open_loop/time_data.csv\"";

class UnseenData : public testing::Test {
 protected:
  // models/recordings/open_loop.toml in a folder of its own, with some words exchanged.
  [[nodiscard]] study::Study study_of(const std::string& from = "",
                                      const std::string& to = "") const {
    auto text = read_whole(fs::path(CHLADNI_SOURCE_DIR) / "models/recordings/open_loop.toml");
    if (!from.empty()) {
      const auto at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    }
    const auto file = folder_.path() / "open_loop.toml";
    write_atomically(file, text);
    return study::read_study(file);
  }

  [[nodiscard]] static std::string with_second(const std::string& file) {
    return std::string(kFirst) + "\nvalidation = \"" + file + "\"";
  }

  void simulate(const study::Study& study, const std::string& out) const {
    QuietRun quiet(study, folder_.path() / out);
    simulate_command.run(study, quiet.run());
  }

  // Three other realisations, of other noise and phases.
  void simulate_second() const {
    auto text = read_whole(fs::path(CHLADNI_SOURCE_DIR) / "models/recordings/open_loop.toml");
    const std::string realisations = "realisations = 4";
    text.replace(text.find(realisations), realisations.size(), "realisations = 3");
    const auto file = folder_.path() / "other.toml";
    write_atomically(file, "seed = 2\n" + text);
    simulate(study::read_study(file), "second");
  }

  [[nodiscard]] io::Json identify(const study::Study& study, std::string* shown = nullptr) const {
    QuietRun quiet(study, folder_.path() / "identified");
    try {
      identify_command.run(study, quiet.run());
    } catch (const NumericalFailure&) {
      // A fit with too few modes is not to be trusted, and its files are there.
    }
    if (shown != nullptr) *shown = quiet.shown();
    return io::parse_json(read_whole(folder_.path() / "identified" / "identified.json"))
        .at("validation");
  }

  static void expect_noise(const io::Json& predicted) {
    const auto& whole = predicted.at("whole");
    EXPECT_NEAR(whole.at("residual_over_noise").number(), predicted.at("expected").number(),
                4.0 * whole.at("residual_over_noise_std").number());
    EXPECT_NEAR(whole.at("relative_error").number(), whole.at("noise_floor").number(),
                0.1 * whole.at("noise_floor").number());
  }

  static void expect_more(const io::Json& predicted) {
    const auto& whole = predicted.at("whole");
    EXPECT_GT(
        whole.at("residual_over_noise").number(),
        predicted.at("expected").number() + 10.0 * whole.at("residual_over_noise_std").number());
  }

  TestFolder folder_{"unseen_data"};
};

TEST_F(UnseenData, IsPredictedDownToItsNoise) {
  simulate(study_of(), "open_loop");
  simulate_second();
  std::string shown;
  const auto json = identify(study_of(kFirst, with_second("second/time_data.csv")), &shown);
  const auto& left_out = json.at("cross_validation");
  EXPECT_EQ(left_out.at("by").string(), "realisations");
  ASSERT_EQ(left_out.at("parts").array().size(), 4U);
  EXPECT_EQ(left_out.at("parts").array()[1].at("name").string(), "realisation 2");
  expect_noise(left_out);
  expect_noise(json.at("second_record"));
  EXPECT_EQ(json.at("second_record").at("file").string(), "time_data.csv");
  EXPECT_NE(shown.find("realisations left out in turn (4): predicted to "), std::string::npos)
      << shown;
  EXPECT_NE(shown.find("second record time_data.csv: predicted to "), std::string::npos) << shown;
  EXPECT_EQ(shown.find("lacks or invents"), std::string::npos) << shown;
}

TEST_F(UnseenData, IsPredictedWorseByAModelWithTooFewModes) {
  simulate(study_of(), "open_loop");
  simulate_second();
  std::string shown;
  const auto json =
      identify(study_of("[identification]",
                        "validation = \"second/time_data.csv\"\n[identification]\nmodes = 2"),
               &shown);
  expect_more(json.at("cross_validation"));
  expect_more(json.at("second_record"));
  EXPECT_NE(shown.find("lacks or invents"), std::string::npos) << shown;
}

TEST_F(UnseenData, IsNotLookedAtWhereTheStudySaysSo) {
  simulate(study_of(), "open_loop");
  const auto json =
      identify(study_of("[identification]", "[identification]\ncross_validation = false"));
  EXPECT_TRUE(io::text(json.at("cross_validation")).starts_with("null"));
  EXPECT_TRUE(io::text(json.at("second_record")).starts_with("null"));
}

TEST_F(UnseenData, IsRefusedWhereItIsNotOfTheSameChannels) {
  simulate(study_of(), "open_loop");
  const auto file = folder_.path() / "second.csv";
  auto text = read_whole(folder_.path() / "open_loop" / "time_data.csv");
  const auto at = text.find("tip");
  ASSERT_NE(at, std::string::npos);
  write_atomically(file, text.replace(at, 3, "top"));
  const auto study = study_of(kFirst, with_second("second.csv"));
  const auto refusal = refusal_of([&] { return identify(study); });
  EXPECT_NE(refusal.find("second.csv: the channel \"tip\" is not in it; expected every channel of"),
            std::string::npos)
      << refusal;
}

TEST_F(UnseenData, IsRefusedWhereItIsInAnotherUnit) {
  simulate(study_of(), "open_loop");
  auto data = io::read_time(folder_.path() / "open_loop" / "time_data.csv",
                            {.sensor_names = {"tip", "middle"}, .actuator_names = {"coil1"}})
                  .data;
  for (auto& output : data.outputs) {
    output.unit = "m/s^2";
    output.kind = modal::FrfKind::accelerance;
  }
  (void)io::write_time(folder_.path() / "second.uff", data);
  const auto study = study_of(kFirst, with_second("second.uff"));
  const auto refusal = refusal_of([&] { return identify(study); });
  EXPECT_NE(refusal.find("second.uff: \"tip\" is measured in m/s^2, acceleration, and the study "
                         "says displacement"),
            std::string::npos)
      << refusal;
}

TEST_F(UnseenData, IsRefusedWhereItHasNoLinesOfTheBand) {
  simulate(study_of(), "open_loop");
  simulate(study_of("band = [\"20 Hz\", \"1200 Hz\"]", "band = [\"1100 Hz\", \"1400 Hz\"]"),
           "second");
  const auto study = study_of(kFirst, with_second("second/time_data.csv"));
  const auto refusal = refusal_of([&] { return identify(study); });
  EXPECT_NE(refusal.find("second/time_data.csv: 0 lines from 20"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("expected 9 lines or more in that band"), std::string::npos) << refusal;
}

TEST_F(UnseenData, IsRefusedBesideNothingThatIsFitted) {
  const auto refusal =
      refusal_of([&] { return study_of(kFirst, "shapes = \"s.csv\"\nvalidation = \"v.csv\""); });
  EXPECT_NE(refusal.find("measurement.validation changes nothing here"), std::string::npos)
      << refusal;
}

}  // namespace
}  // namespace chladni::app
