// chladni identify on what was measured; the data are not part of the project.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/command.h"
#include "host/atomic_file.h"
#include "io/json.h"
#include "rotation/turn.h"
#include "tests/app/quiet_run.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

class IdentifyMeasured : public testing::Test {
 protected:
  [[nodiscard]] io::Json identified(const std::string& text, const fs::path& data) const {
    const study::Study study =
        study::parse_study(text, folder_.path() / "study.toml", {data.parent_path()});
    QuietRun quiet(study, folder_.path() / "out");
    identify_command.run(study, quiet.run());
    return io::parse_json(read_whole(folder_.path() / "out/identified.json"));
  }

  TestFolder folder_{"identify_measured"};
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

std::vector<double> frequencies(const io::Json& json) {
  std::vector<double> result;
  for (const auto& mode : json.at("modes").array()) {
    result.push_back(mode.at("frequency_hz").number());
  }
  return result;
}

void expect_among(const std::vector<double>& found, double wanted, double within) {
  EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                          [&](double one) { return std::abs(one - wanted) < within; }))
      << wanted << " Hz is not there";
}

const fs::path kData = fs::path(CHLADNI_SOURCE_DIR) / "../shared/data";

TEST_F(IdentifyMeasured, TheMeasuredBeamOfEindhoven) {
  EVERY_EIGHTH_LANDING();
  const auto file = fs::absolute(kData / "tue-beam-3x3/frf_3x3.csv").lexically_normal();
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  const auto text =
      replaced(replaced(read_whole(fs::path(CHLADNI_SOURCE_DIR) / "models/beam/measured.toml"),
                        "../../../shared/data/tue-beam-3x3/frf_3x3.csv", file.string()),
               "stabilisation = 30\n", "");
  const auto json = identified(text, file);
  const auto found = frequencies(json);
  expect_among(found, 2.64, 0.05);
  for (const double wanted : {5.11, 32.74, 51.92, 93.11, 105.74}) expect_among(found, wanted, 0.05);
  for (const double wanted : {172.4, 183.7, 289.1, 437.5, 450.1, 643.7}) {
    expect_among(found, wanted, 1e-3 * wanted);
  }
  EXPECT_NEAR(json.at("delay_s").number(), 0.968e-3, 3e-6);
}

// Nine rows of a bar, a blow each. Damping is near 1e-4, so the resonances are one to ten lines
// wide, and move from row to row by up to four tenths of half their width: by 58e-6 of the
// frequency between the first row and the last.
class FreeBar : public IdentifyMeasured {
 protected:
  [[nodiscard]] static fs::path file() {
    return fs::absolute(kData / "freebar-modelab/frf_9x1_roving_hammer.csv.gz").lexically_normal();
  }

  [[nodiscard]] static std::string study(const std::string& identification) {
    std::string text = R"(
geometry = { beam = { length = "1270 mm", width = "35 mm", thickness = "35 mm" } }
material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, density = "7850 kg/m^3" }
[[sensor]]
name = "y1"
at = ["-152 mm", "0 mm"]
direction = "z"
quantity = "acceleration"
[identification]
unit = "m/s^2"
band = ["65 Hz", "1000 Hz"]
)" + identification + "[measurement]\nfrf = \"" +
                       file().string() + "\"\n";
    const std::vector<double> at{-552, -402, -277, -152, -2, 148, 273, 398, 548};
    for (std::size_t j = 0; j < at.size(); ++j) {
      text += "[[actuator]]\nname = \"u" + std::to_string(j + 1) + "\"\nat = [\"" +
              std::to_string(at[j]) + " mm\", \"0 mm\"]\ndirection = \"z\"\n";
    }
    return text;
  }

  // Half-power widths of single rows, as its README has them, give 6e-5 to 1.1e-4; single poles
  // fitted to single rows 1.4e-4 for the lowest mode, whose peak is one line wide.
  static void expect_the_four_modes(const io::Json& json) {
    const std::vector<double> wanted{111.992, 306.855, 596.37, 974.12};
    io::JsonArray modes;
    for (const auto& mode : json.at("modes").array()) {
      if (!std::get<bool>(mode.at("rigid").value())) modes.push_back(mode);
    }
    ASSERT_EQ(modes.size(), wanted.size());
    for (std::size_t m = 0; m < wanted.size(); ++m) {
      EXPECT_NEAR(modes[m].at("frequency_hz").number(), wanted[m], 3e-5 * wanted[m]);
      EXPECT_LT(modes[m].at("frequency_std_hz").number(), 1e-5 * wanted[m]);
      EXPECT_GT(modes[m].at("damping_ratio").number(), 6e-5);
      EXPECT_LT(modes[m].at("damping_ratio").number(), 1.5e-4);
      EXPECT_GT(modes[m].at("damping_std").number(), 0.0);
      EXPECT_LT(modes[m].at("damping_std").number(), 5e-6);
    }
  }
};

TEST_F(FreeBar, HasTheModesThatAreAskedFor) {
  EVERY_FOURTH_LANDING();
  if (!fs::exists(file())) GTEST_SKIP() << file() << " is not here";
  expect_the_four_modes(identified(study(R"(rigid_body_modes = 0
modes = 4
weighting = "inverse_magnitude"
cut_off_db = 60
)"),
                                   file()));
}

TEST_F(FreeBar, HasFourModesThatAreFound) {
  EVERY_EIGHTH_LANDING();
  if (!fs::exists(file())) GTEST_SKIP() << file() << " is not here";
  const auto json = identified(study(""), file());
  expect_the_four_modes(json);
  const auto& channels = json.at("fit").at("per_channel").array();
  EXPECT_NEAR(channels.front().at("drift").number(), 16e-6, 4e-6);
  EXPECT_NEAR(channels.back().at("drift").number(), -42e-6, 4e-6);
}

}  // namespace
}  // namespace chladni::app
