// What is refused of an identified.json that is read back.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "steps/measured_modes.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::steps {
namespace {

const std::string kBeside = R"(measurement = { modes = "identified.json" }
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }
material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, density = "7850 kg/m^3" }
sensor = [{ name = "s1", at = ["-250 mm", "150 mm"], direction = "z" },
          { name = "s2", at = ["110 mm", "40 mm"], direction = "z" }]
actuator = [{ name = "a1", at = ["-170 mm", "-120 mm"], direction = "z" }]
)";

const std::string kSound = R"({"damping": "modal", "sensors": ["s1", "s2"], "actuators": ["a1"],
 "modes": [
 {"frequency_hz": 60, "damping_ratio": 0.02, "frequency_std_hz": 0.05, "damping_std": 0.001},
 {"frequency_hz": 80, "damping_ratio": 0.01, "frequency_std_hz": 0.08, "damping_std": 0.002}],
 "output_matrix": [[1, 2], [1, 3]], "output_std": [[0.1, 0.1], [0.1, 0.1]],
 "input_matrix": [[1], [4]], "input_std": [[0.1], [0.2]]})";

class IdentifiedModes : public testing::Test {
 protected:
  // The message with which kSound is refused where `mark` is `by`.
  std::string refusal(const std::string& mark, const std::string& by) {
    auto text = kSound;
    const auto at = text.find(mark);
    EXPECT_NE(at, std::string::npos) << mark;
    text.replace(at, mark.size(), by);
    std::ofstream(folder_.path() / "identified.json") << text;
    const auto study = study::parse_study(kBeside, folder_.path() / "study.toml");
    return refusal_of([&] {
      stage::Work work;
      return measured_modes(study, work);
    });
  }

  void expect_refused(const std::string& mark, const std::string& by, const std::string& words) {
    const auto said = refusal(mark, by);
    EXPECT_NE(said.find("identified.json: " + words), std::string::npos) << said;
  }

  app::TestFolder folder_{"identified_modes"};
};

TEST_F(IdentifiedModes, AreTakenWhereTheyAreSound) {
  EXPECT_EQ(refusal("80", "80"), "");
  EXPECT_EQ(refusal("80", "60"), "");  // two modes of one frequency
  EXPECT_EQ(refusal("\"damping_ratio\": 0.01", "\"damping_ratio\": null"), "");
}

TEST_F(IdentifiedModes, OfNumbersThatAreNoneOfAModeAreRefused) {
  expect_refused("80", "-80", "mode 2: frequency_hz is -80; expected 0 or more");
  expect_refused("60", "null", "mode 1: frequency_hz is null; expected a number of Hz");
  expect_refused("0.01", "5", "mode 2: damping_ratio is 5; expected a ratio below 1");
  expect_refused("0.01", "-1.5", "mode 2: damping_ratio is -1.5; expected a ratio below 1");
  expect_refused("0.05", "-0.05", "mode 1: frequency_std_hz is -0.05; expected 0 or more");
  expect_refused("0.002", "-0.002", "mode 2: damping_std is -0.002; expected 0 or more");
}

TEST_F(IdentifiedModes, ThatAreThereTwiceAreRefused) {
  expect_refused("\"s1\", \"s2\"", "\"s1\", \"s1\"",
                 "sensors 1 and 2 are both \"s1\"; expected different names");
  const std::string last = R"("frequency_hz": 80, "damping_ratio": 0.01, "frequency_std_hz": 0.08)";
  auto text = kSound;
  const std::string second =
      R"("frequency_hz": 60, "damping_ratio": 0.02, "frequency_std_hz": 0.08)";
  text.replace(text.find(last), last.size(), second);
  const std::string shapes = "[[1, 2], [1, 3]]";
  text.replace(text.find(shapes), shapes.size(), "[[1, 1], [1, 1]]");
  const std::string inputs = "[[1], [4]]";
  text.replace(text.find(inputs), inputs.size(), "[[1], [1]]");
  expect_refused(kSound, text, "modes 1 and 2 are one: the same frequency, damping and shape");
}

}  // namespace
}  // namespace chladni::steps
