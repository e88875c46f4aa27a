// What is said before the long step: counts, sizes, and what cannot be.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "mesh/surface.h"
#include "stage/forecast.h"
#include "stage/solution.h"
#include "steps/interpolation.h"
#include "tests/app/quiet_run.h"

namespace chladni::app {
namespace {

testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in\n" << text;
}

const std::string kAluminium =
    "\nmaterial = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 kg/m^3\" "
    "}\n";
const std::string kSmall =
    "geometry = { plate = { length = \"100 mm\", width = \"60 mm\", thickness = \"5 mm\" } }" +
    kAluminium + "mesh = { edge_length = \"20 mm\", order = 2 }\n";

class Before : public ::testing::Test {
 protected:
  study::Study study_of(const std::string& text) const {
    return study::parse_study(text, folder_.path() / "study.toml");
  }

  // What `check` refuses, and says before.
  std::string refusal(const std::string& text, const Command& command = check_command) {
    const study::Study study = study_of(text);
    QuietRun quiet(study, folder_.path() / "out");
    std::string what;
    try {
      command.run(study, quiet.run());
    } catch (const std::exception& e) {
      what = e.what();
    }
    shown_ = quiet.shown();
    said_ = quiet.said();
    return what;
  }

  TestFolder folder_{"forecast"};
  std::string shown_, said_;
};

// Flexible frequencies of a free square plate and of a strip
// (tests/app/body/imported_modes_test.cpp).
TEST_F(Before, ModesAreCountedByWeylsLaw) {
  const study::Study plate = study_of(
      "geometry = { plate = { length = \"600 mm\", width = \"600 mm\", thickness = \"20 mm\" } }" +
      kAluminium);
  const auto body = stage::understood(plate, stage::outline_of(plate));
  EXPECT_NEAR(stage::modes_below(body, 2620.0) / (6 + 21), 1.0, 0.2);
  EXPECT_NEAR(stage::modes_below(body, 1040.0) / (6 + 10), 1.0, 0.3);
  const study::Study strip = study_of(
      "geometry = { beam = { length = \"500 mm\", width = \"20 mm\", thickness = \"2 mm\" } }\n"
      "material = { youngs_modulus = \"210 GPa\", poissons_ratio = 0.3, density = \"7850 kg/m^3\" "
      "}");
  const auto long_body = stage::understood(strip, stage::outline_of(strip));
  EXPECT_NEAR(stage::modes_below(long_body, 1240.0) / (6 + 11), 1.0, 0.5);
}

TEST_F(Before, AFrequencyThatNoMeshReachesIsRefused) {
  const std::string text = refusal(kSmall + "modes = { up_to = \"1 GHz\" }\n");
  EXPECT_TRUE(says(text, "modes.up_to is 1e+09 Hz, and about "));
  EXPECT_TRUE(says(text, "Ask for less than about "));
  EXPECT_TRUE(says(stage::forecast(study_of(kSmall + "modes = { up_to = \"1 GHz\" }\n"),
                                   stage::outline_of(study_of(kSmall)))
                       .line(),
                   "degrees of freedom, over 1000 TB of memory and "));
  EXPECT_EQ(refusal(kSmall + "modes = { up_to = \"10 kHz\" }\n"), "");
}

TEST_F(Before, MoreModesCostMore) {
  const study::Study few = study_of(kSmall + "modes = { count = 20 }\n");
  const study::Study many = study_of(kSmall + "modes = { count = 200 }\n");
  const auto outline = stage::outline_of(few);
  const auto little = stage::forecast(few, outline);
  const auto much = stage::forecast(many, outline);
  EXPECT_EQ(little.degrees_of_freedom, much.degrees_of_freedom);
  EXPECT_GT(much.memory_bytes, little.memory_bytes + 180 * 8 * little.degrees_of_freedom);
  EXPECT_GT(much.seconds, little.seconds);
}

// The wafer and the table beside it have cells as small as the wafer is thick: 25 times those of
// the table alone. `modes` began to mesh what it then refused.
TEST_F(Before, AThinWaferOnATableIsInTheForecast) {
  const study::Study table = study_of(
      "geometry = { wafer_table = { length = \"60 mm\", width = \"60 mm\", height = \"8 mm\", "
      "wafer = { diameter = \"40 mm\", thickness = \"0.8 mm\" } } }" +
      kAluminium + "mesh = { edge_length = \"8 mm\" }\n");
  QuietRun quiet(table, folder_.path() / "out");
  const auto outline = stage::outline_of(table);
  const auto told = stage::forecast(table, outline);
  const auto body = stage::body_of(table, outline, quiet.run());
  const auto known = stage::forecast(table, body, stage::understood(table, outline));
  EXPECT_FALSE(told.exact);
  EXPECT_EQ(told.order, known.order);
  EXPECT_NEAR(told.degrees_of_freedom / known.degrees_of_freedom, 1.0, 0.25);
  EXPECT_NEAR(told.memory_bytes / known.memory_bytes, 1.0, 0.25);
}

// A guess may be a third off, a mesh that is there is believed.
TEST_F(Before, WhatIsKnownIsRefusedSooner) {
  stage::Cost cost;
  cost.memory_bytes = 1.2e9;
  EXPECT_TRUE(stage::fits(cost, 1e9));
  cost.exact = true;
  EXPECT_FALSE(stage::fits(cost, 1e9));
  EXPECT_TRUE(stage::fits(cost, 1.2e9));
}

TEST_F(Before, OfADiscItsDiameterIsTold) {
  const study::Study mirror = study_of(
      "geometry = { disc = { diameter = \"200 mm\", thickness = \"6 mm\" } }" + kAluminium);
  const auto body = stage::understood(mirror, stage::outline_of(mirror));
  EXPECT_TRUE(says(body.line(), "200.0 x 200.0 x 6.0 mm (diameter 200.0 mm)  "));
}

TEST_F(Before, OfAThinOrSmallBodyNoDigitIsLost) {
  const auto line = [&](const std::string& diameter, const std::string& thickness) {
    const study::Study wafer = study_of("geometry = { disc = { diameter = \"" + diameter +
                                        "\", thickness = \"" + thickness + "\" } }" + kAluminium);
    return stage::understood(wafer, stage::outline_of(wafer)).line();
  };
  EXPECT_TRUE(
      says(line("300 mm", "775 um"), "300.0 x 300.0 x 0.775 mm (diameter 300.0 mm)  147.91 g"));
  EXPECT_TRUE(says(line("50.8 mm", "30 um"), "50.8 x 50.8 x 0.03 mm (diameter 50.8 mm)  0.1642 g"));
  EXPECT_TRUE(says(line("1.5 mm", "12.5 um"), "1.5 x 1.5 x 0.0125 mm (diameter 1.5 mm)  "));
}

TEST_F(Before, CheckFindsModesThatWillNotBeThere) {
  EXPECT_TRUE(says(refusal(kSmall + "modes = { count = 4 }\n[placement]\nmodes = [1, 99]\n"),
                   "study.toml:6:9: placement.modes asks for flexible mode 99, but 4 will be"));
  EXPECT_TRUE(says(refusal(kSmall + "modes = { count = 4 }\n[priors]\nmodes = 5\n"),
                   "study.toml:6:9: priors.modes asks for flexible mode 5, but 4 will be"));
  EXPECT_EQ(refusal(kSmall + "modes = { count = 4 }\n[placement]\nmodes = 4\n"), "");
  const std::string below = kSmall + "modes = { up_to = \"5 kHz\" }\n[placement]\n";
  for (const auto* asked : {"up_to = \"6 kHz\"\n", "modes = { up_to = \"6 kHz\" }\n"}) {
    EXPECT_TRUE(
        says(refusal(below + asked),
             "study.toml:6:9: placement asks for modes up to 6000 Hz, but those up to 5000"))
        << asked;
  }
  EXPECT_EQ(refusal(below + "up_to = \"5 kHz\"\n"), "");
}

// How many lie below a frequency is known only after the solution, and about before it.
TEST_F(Before, CheckWarnsOfModesThatAreUnlikelyBelowAFrequency) {
  const std::string below = kSmall + "modes = { up_to = \"5 kHz\" }\n";
  const auto warnings = [&](const std::string& text) {
    const study::Study one = study_of(below + text);
    return stage::unlikely_modes(one, stage::understood(one, stage::outline_of(one)));
  };
  for (const auto* text : {"[placement]\nmodes = [1, 99]\n", "[priors]\nmodes = 99\n",
                           "[expect]\nfrequency_99 = { value = \"4 kHz\", within = \"1 %\" }\n"}) {
    ASSERT_EQ(warnings(text).size(), 1U) << text;
    EXPECT_TRUE(says(warnings(text).front(), "asks for flexible mode 99, but only about"));
    EXPECT_EQ(refusal(below + text), "") << text;
    EXPECT_TRUE(says(said_, "asks for flexible mode 99, but only about")) << text;
  }
  EXPECT_TRUE(warnings("[placement]\nmodes = [1, 2]\n").empty());
  const study::Study many = study_of(kSmall + "modes = { up_to = \"100 kHz\" }\n");
  const double likely =
      stage::modes_below(stage::understood(many, stage::outline_of(many)), 100e3) - 6.0;
  ASSERT_GT(likely, 20.0);
  const auto asked = [&](double times) {
    const study::Study one =
        study_of(kSmall + "modes = { up_to = \"100 kHz\" }\n[priors]\nmodes = " +
                 std::to_string(std::lround(times * likely)) + "\n");
    return stage::unlikely_modes(one, stage::understood(one, stage::outline_of(one)));
  };
  EXPECT_TRUE(asked(1.9).empty()) << "the estimate is right within a factor of 1.5";
  EXPECT_EQ(asked(2.1).size(), 1U);
}

// A mode that is expected is computed, and counts in the forecast.
TEST_F(Before, TheForecastCountsModesThatAreExpected) {
  const auto modes = [&](const std::string& text) {
    const study::Study one = study_of(kSmall + "modes = { count = 4 }\n" + text);
    return stage::modes_wanted(one, stage::understood(one, stage::outline_of(one)));
  };
  EXPECT_EQ(modes(""), 10.0);
  EXPECT_EQ(modes("[expect]\nfrequency_30 = { value = \"9 kHz\", within = \"50 %\" }\n"), 36.0);
}

TEST_F(Before, CheckFindsDataThatAreNotThere) {
  const std::string channel =
      "[[sensor]]\nname = \"s\"\nat = [\"0 mm\", \"0 mm\"]\ndirection = \"z\"\n";
  const std::string text =
      refusal(kSmall + channel + "[measurement]\nfrf = \"gone.csv\"\ntruth = \"real.toml\"\n");
  EXPECT_TRUE(says(text, "study.toml:9:7: measurement.frf \"gone.csv\" does not exist"));
  EXPECT_TRUE(says(text, "study.toml:10:9: measurement.truth \"real.toml\" does not exist"));
  std::ofstream(folder_.path() / "gone.csv") << "freq_hz\n";
  std::ofstream(folder_.path() / "real.toml") << kSmall;
  EXPECT_EQ(
      refusal(kSmall + channel + "[measurement]\nfrf = \"gone.csv\"\ntruth = \"real.toml\"\n"), "");
}

TEST_F(Before, CheckLooksIntoTheStudiesThatAreNamed) {
  const std::string channel =
      "[[sensor]]\nname = \"s\"\nat = [\"0 mm\", \"0 mm\"]\ndirection = \"z\"\n";
  const auto named = [&](const std::string& text) {
    std::ofstream(folder_.path() / "real.toml") << text;
    return refusal(kSmall + channel + "[measurement]\ntruth = \"real.toml\"\n");
  };
  const std::string place = "study.toml:9:9: measurement.truth: ";
  EXPECT_EQ(named(kSmall), "");
  std::ofstream(folder_.path() / "real.toml") << kSmall + "modes = { count = 4 }\n";
  const auto of_truth = kSmall + channel + "[measurement]\ntruth = \"real.toml\"\nmodes = ";
  EXPECT_TRUE(says(refusal(of_truth + "99\n"),
                   place + "measurement.modes asks for 99 modes, but 4 will be computed of real"));
  EXPECT_EQ(refusal(of_truth + "4\n"), "");
  std::ofstream(folder_.path() / "real.toml") << kSmall +
                                                     "modes = { count = 4 }\n[expect]\nfrequency_6 "
                                                     "= { value = \"9 kHz\", within = \"50 %\" }\n";
  EXPECT_EQ(refusal(of_truth + "6\n"), "") << "a mode that is expected is computed";
  EXPECT_TRUE(says(named("geometry = { file = \"none.stl\", unit = \"mm\" }" + kAluminium), place));
  EXPECT_TRUE(says(named(kSmall + "[[support]]\npatch = \"nix\"\nfixed = \"z\"\n"),
                   "support.patch: the body has no patch \"nix\""));
  const auto series = kSmall + "[[specimen]]\nname = \"p\"\nstudy = \"one.toml\"\n";
  EXPECT_TRUE(
      says(refusal(series), "study.toml:6:9: specimen[0].study \"one.toml\" does not exist"));
  std::ofstream(folder_.path() / "one.toml")
      << "extends = \"study.toml\"\n[measurement]\nmodes = \"gone.csv\"\n";
  std::ofstream(folder_.path() / "study.toml") << series;
  EXPECT_TRUE(says(refusal(series), "one.toml:3:9: measurement.modes \"gone.csv\" does not exist"));
}

TEST_F(Before, CheckTellsOfFilesBesideWhatTheBodyLacks) {
  const auto text =
      refusal(kSmall + "[placement]\non = [\"nix\"]\n[measurement]\ntruth = \"gone.toml\"\n");
  EXPECT_TRUE(says(text, "the body has no patch \"nix\""));
  EXPECT_TRUE(says(text, "study.toml:7:9: measurement.truth \"gone.toml\" does not exist"));
}

TEST_F(Before, CheckFindsAFolderWhereAFileIsExpected) {
  std::filesystem::create_directories(folder_.path() / "dir.csv");
  EXPECT_TRUE(says(refusal(kSmall + "[measurement]\nfrf = \"dir.csv\"\n"),
                   "measurement.frf \"dir.csv\" is a folder; expected a file"));
}

TEST_F(Before, CheckFindsPointsThatAreOffTheBody) {
  const std::string off = "[\"900 mm\", \"0 mm\"]";
  EXPECT_TRUE(says(refusal(kSmall + "[placement]\ninterest = [{ at = " + off + " }]\n"),
                   "study.toml:5:1: a point of interest is not on the body"));
  EXPECT_TRUE(
      says(refusal(kSmall + "[interpolation]\npoint = [{ name = \"p\", at = " + off + " }]\n"),
           "study.toml:5:1: interpolation.point \"p\" is not on the body"));
  EXPECT_TRUE(says(
      refusal(kSmall +
              "[interpolation]\npoint = [{ name = \"p\", at = [\"0 mm\", \"0 mm\", \"1 m\"] }]\n"),
      "interpolation.point \"p\" is not on the body, which is 1e+03 mm away"));
}

TEST_F(Before, InterpolateSaysThatNothingIsMeasuredBeforeItSolves) {
  EXPECT_TRUE(says(refusal(kSmall, interpolate_command), "nothing is measured"));
  EXPECT_EQ(shown_, "");
  for (const std::string key : {"frf", "shapes", "truth"}) {
    const auto gone = kSmall + "[measurement]\n" + key + " = \"gone.csv\"\n";
    EXPECT_TRUE(says(refusal(gone, interpolate_command), "gone.csv: there is no such file"));
    EXPECT_EQ(shown_, "") << key;
  }
}

TEST_F(Before, DiagnoseSaysThatNothingIsMeasuredBeforeItSolves) {
  EXPECT_TRUE(says(refusal(kSmall, diagnose_command), "no responses are measured"));
  EXPECT_EQ(shown_, "");
  EXPECT_TRUE(says(refusal(kSmall + "[measurement]\nfrf = \"gone.csv\"\n", diagnose_command),
                   "gone.csv: there is no such file"));
  EXPECT_EQ(shown_, "");
}

TEST_F(Before, IdentifySaysThatNothingIsMeasuredBeforeItSolves) {
  EXPECT_TRUE(says(refusal(kSmall, identify_command), "no responses are measured"));
  EXPECT_EQ(shown_, "");
}

}  // namespace
}  // namespace chladni::app
