// chladni compare: what diagnose compares, without the search.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/json.h"
#include "rotation/turn.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

// A cantilever plate; `more` hangs on the one that is measured and that the simulation does not
// know.
std::string plate(const std::string& more) {
  std::string text = R"(
geometry = { plate = { length = "300 mm", width = "240 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 12, damping_ratio = 0.01 }
support = [{ patch = "x_min", fixed = "xyz" }]
)" + more;
  const char* places[] = {R"("-120 mm", "-100 mm")", R"("120 mm", "-100 mm")",
                          R"("0 mm", "110 mm")", R"("40 mm", "10 mm")"};
  for (const std::string kind : {"sensor", "actuator"}) {
    int number = 0;
    for (const char* place : places) {
      text += "[[" + kind + "]]\nname = \"" + kind.substr(0, 1) + std::to_string(++number) +
              "\"\nat = [" + place + "]\ndirection = \"z\"\n";
    }
  }
  return text;
}

constexpr const char* kMass = R"([[attachment]]
kind = "mass"
name = "magnet"
at = ["100 mm", "80 mm"]
mass = "40 g"
)";

constexpr const char* kExperiment = R"([experiment]
sample_rate = "8192 Hz"
samples = 8192
band = ["60 Hz", "1500 Hz"]
realisations = 3
noise_ratio = 0.002
)";

class Compare : public testing::Test {
 protected:
  void run(const Command& command, const std::string& text, const std::string& out) {
    const auto study = study::parse_study(text, folder_.path() / "study.toml");
    QuietRun quiet(study, folder_.path() / out);
    command.run(study, quiet.run());
    shown_ = quiet.shown();
  }
  io::Json json(const std::string& file) const {
    return io::parse_json(read_whole(folder_.path() / file));
  }
  void measure() { run(simulate_command, plate(kMass) + kExperiment, "truth"); }

  const std::string measured_ = "[measurement]\nfrf = \"truth/measured.csv\"\n";
  TestFolder folder_{"compare"};
  std::string shown_;
};

TEST_F(Compare, SaysNothingIsWrongWhereNothingIs) {
  EVERY_FOURTH_LANDING();
  measure();
  run(compare_command, plate(kMass) + measured_, "out");
  const auto all = json("out/comparison.json");
  EXPECT_LT(all.at("relative_error").number(), 0.02);
  ASSERT_GE(all.at("modes").array().size(), 4U);
  for (const auto& pair : all.at("modes").array()) {
    EXPECT_LT(std::abs(pair.at("change").number()), 1e-4);
    EXPECT_GT(pair.at("mac").number(), 0.999);
  }
}

std::string in_accelerations(std::string text) {
  const std::string head = "[[sensor]]\n";
  for (auto at = text.find(head); at != std::string::npos; at = text.find(head, at + 1)) {
    text.insert(at + head.size(), "quantity = \"acceleration\"\n");
  }
  return text;
}

// Sampled accelerations folded back what lies above half the sample rate, and forces reached them
// through the flexibility in series with a dashpot.
TEST_F(Compare, TakesAccelerationsOfItsOwnForThoseOfTheStudy) {
  EVERY_FOURTH_LANDING();
  const auto damped = in_accelerations(plate(std::string(kMass) + R"([[attachment]]
kind = "spring"
name = "cord"
at = ["110 mm", "0 mm"]
direction = "z"
stiffness = "500 N/m"
damping = "0.5 N s/m"
)"));
  run(simulate_command, damped + kExperiment, "truth");
  run(compare_command, damped + measured_ + "[identification]\nunit = \"SI\"\n", "out");
  const auto all = json("out/comparison.json");
  EXPECT_LT(all.at("relative_error").number(), 1.2 * all.at("noise_floor").number());
  // The table of modes left the dashpot out of the simulated damping ratios.
  ASSERT_GE(all.at("modes").array().size(), 4U);
  double most = 0.0;
  for (const auto& pair : all.at("modes").array()) {
    const double simulated = pair.at("simulated_damping").number();
    EXPECT_NEAR(simulated, pair.at("measured_damping").number(), 0.02 * simulated);
    most = std::max(most, simulated);
  }
  EXPECT_GT(most, 0.0102);
}

TEST_F(Compare, TellsTheDeviationsThatAMassLeaves) {
  EVERY_FOURTH_LANDING();
  measure();
  run(compare_command, plate("") + measured_, "out");
  const auto all = json("out/comparison.json");
  EXPECT_GT(all.at("relative_error").number(), 0.1);
  EXPECT_EQ(all.at("per_channel").array().size(), 16U);
  double most = 0.0;
  for (const auto& pair : all.at("modes").array()) {
    EXPECT_LT(pair.at("change").number(), 1e-4) << "a mass raises no frequency";
    most = std::max(most, -pair.at("change").number());
  }
  EXPECT_GT(most, 0.005);
  EXPECT_NE(shown_.find("MAC"), std::string::npos);
  EXPECT_NE(shown_.find("error of"), std::string::npos);
  EXPECT_EQ(shown_.find("probability"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_.path() / "out/diagnosis.json"));
}

// The same numbers as the discrepancy of a diagnosis.
TEST_F(Compare, IsTheDiscrepancyOfADiagnosis) {
  EVERY_FOURTH_LANDING();
  measure();
  const auto text = plate("") + measured_ + "[diagnosis]\neffects = [\"point_mass\"]\n";
  run(compare_command, text, "compared");
  run(diagnose_command, text, "diagnosed");
  const auto alone = json("compared/comparison.json");
  const auto part = json("diagnosed/diagnosis.json").at("discrepancy");
  for (const auto* key : {"modes", "mac", "per_channel", "sensors", "band_error"}) {
    EXPECT_EQ(io::text(alone.at(key)), io::text(part.at(key))) << key;
  }
}

TEST_F(Compare, PutsModesOfAFileBesideTheSimulation) {
  run(modes_command, plate(kMass), "truth");
  std::string table = "frequency_hz\n";
  const auto modes = json("truth/modes.json").at("frequency_hz").array();
  int count = 0;
  for (const auto& hz : modes) {
    if (hz.number() > 0.0 && count++ < 5) table += std::to_string(hz.number()) + "\n";
  }
  std::ofstream(folder_.path() / "modes.csv") << table;
  run(compare_command, plate("") + "[measurement]\nmodes = \"modes.csv\"\n", "out");
  const auto pairs = json("out/comparison.json").at("modes").array();
  ASSERT_EQ(pairs.size(), 5U);
  for (const auto& pair : pairs) EXPECT_LT(pair.at("change").number(), 1e-9);
  EXPECT_NE(shown_.find("simulated"), std::string::npos);
}

TEST_F(Compare, AsksForAMeasurement) {
  EXPECT_NE(refusal_of([&] { run(compare_command, plate(""), "out"); }).find("nothing is measured"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::app
