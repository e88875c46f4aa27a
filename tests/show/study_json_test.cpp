// study.json tells every key that a study says.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "show/solution.h"
#include "stage/solution.h"

namespace chladni::show {
namespace {

const std::string kBody = R"(
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
[[sensor]]
name = "s1"
at = ["-250 mm", "250 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["-200 mm", "200 mm"]
direction = "z"
)";

std::string told(const std::string& part, const std::string& key) {
  const auto study =
      study::parse_study(kBody + "[" + part + "]\n" + key + "\n", "bench/study.toml");
  return io::text(io::Json(show::study_json(study, {})).at(part));
}

TEST(StudyJson, TellsEachKeyOfTheIdentification) {
  for (const auto* key :
       {"band = [\"20 Hz\", \"90 Hz\"]", "method = \"thesis\"", "damping = \"general\"",
        "weighting = \"inverse_magnitude\"", "cut_off_db = 60", "model_error = 0.02", "modes = 4",
        "rigid_body_modes = 3", "suspended_modes = 2", "delay = false", "delay_of = \"sensors\"",
        "residual = false", "unit = \"mm\"", "pairs_within = \"2 mm\"", "gain = \"thesis\"",
        "gain_errors = \"sensors\"", "stabilisation = 30"}) {
    EXPECT_NE(told("identification", key), told("identification", "")) << key;
  }
}

TEST(StudyJson, TellsEachKeyOfTheThesisPath) {
  const std::string path = "method = \"thesis\"\n";
  for (const auto* key : {"clip_db = 20", "fraction_degree = 12", "sanathanan_koerner = 100",
                          "levenberg_marquardt = 20", "modal_iterations = 20"}) {
    EXPECT_NE(told("identification", path + key), told("identification", path)) << key;
  }
}

TEST(StudyJson, TellsEachKeyOfTheExperiment) {
  const std::string spring = "cubic_spring = { stiffness = \"1e9 N/m^3\", ";
  const auto text = told("experiment", spring + "sensor = \"s1\", actuator = \"a1\" }");
  EXPECT_NE(text.find("\"cubic_sensor\": \"s1\""), std::string::npos) << text;
  EXPECT_NE(text.find("\"cubic_actuator\": \"a1\""), std::string::npos) << text;
}

TEST(StudyJson, TellsTheFileOfPredictedResponses) {
  EXPECT_NE(told("interpolation", "predicted = \"rows.csv\""), told("interpolation", ""));
}

TEST(StudyJson, TellsEachKeyOfTheDiagnosis) {
  for (const auto* key : {"band = [\"20 Hz\", \"90 Hz\"]", "hold_out_band = [\"70 Hz\", \"90 Hz\"]",
                          "effects = [\"point_mass\"]", "most_causes = 2", "least_evidence = 10",
                          "rival_within = 4", "lines = 200", "tolerances = { gain = 0.02 }"}) {
    EXPECT_NE(told("diagnosis", key), told("diagnosis", "")) << key;
  }
}

}  // namespace
}  // namespace chladni::show
