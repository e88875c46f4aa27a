// A square plate with channels, and a study of it that is placed.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "io/json.h"
#include "show/placement.h"
#include "steps/placement.h"
#include "tests/refusal.h"

namespace chladni::steps {

inline const std::string kPlate = R"(title = "square plate"
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 12, damping_ratio = 0.005 }
sensor = [
  { name = "s1", at = ["-250 mm", "250 mm"], direction = "z" },
  { name = "s2", at = ["250 mm", "250 mm"], direction = "z" },
  { name = "s3", at = ["200 mm", "-100 mm"], direction = "z" },
]
actuator = [
  { name = "a1", at = ["200 mm", "-100 mm"], direction = "z" },
  { name = "a2", at = ["0 mm", "120 mm"], direction = "z" },
  { name = "a3", at = ["-150 mm", "-220 mm"], direction = "z" },
]
)";

class Place : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("chladni_place_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The result of a study whose [placement] is `placement`.
  steps::BestPlaces placed_with(const std::string& placement) {
    const study::Study study =
        study::parse_study(kPlate + "[placement]\n" + placement, "study.toml");
    show::Options options;
    options.folder = folder_ / "out";
    options.pictures = false;
    options.certificate = false;
    show::Talk talk(said_, show::manner_of_stderr(true));
    show::Run run(study, options, shown_, talk);
    const stage::Solution solution = stage::solved(study, run);
    steps::BestPlaces result = steps::best_places(study, solution, run);
    run.show(show::placement_table(solution, result));
    show::leave_placement(study, solution, result, run, true);
    return result;
  }

  std::string refusal(const std::string& placement) {
    return refusal_of([&] { return placed_with(placement); });
  }

  io::Json left() {
    std::ifstream stream(folder_ / "out" / "placement.json");
    std::ostringstream text;
    text << stream.rdbuf();
    return io::parse_json(text.str());
  }

  std::filesystem::path folder_;
  std::ostringstream shown_, said_;
};

inline testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in\n" << text;
}

}  // namespace chladni::steps
