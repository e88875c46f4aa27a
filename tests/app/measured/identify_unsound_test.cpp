// Measurements that are not as a study says: what identify leaves out, suspects and refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/app/measured/identify_beam.h"

namespace chladni::app {
namespace {

// The study of the beam whose model is taken to be exact.
std::string exact_beam() {
  auto text = model("beam/thesis_5x5.toml");
  const auto at = text.find("model_error");
  return text.replace(at, text.find('\n', at) - at, "model_error = 0");
}

void spoil_one_value(modal::FrfSet& set) {
  set.value[700](2, 0) += 80.0 * std::sqrt(set.variance[700](2, 0));
}

// What is said of gains and channels is in the file, too: the terminal folds it.
TEST_F(Identify, WarningsOfChannelsAreInItsJson) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  for (auto& value : set.value) value.row(1) *= -1.0;
  write("thesis_5x5.csv", set);
  const auto said = run(identify_command, exact_beam());
  EXPECT_NE(said.find("turned around"), std::string::npos) << said;
  const auto identified = left("identified.json");
  const auto& warnings = identified.at("warnings").array();
  EXPECT_TRUE(std::ranges::any_of(warnings, [](const io::Json& one) {
    return one.string().find("turned around") != std::string::npos;
  }));
}

// One value that is off makes a mode of its own: said, written, and not passed for a success.
TEST_F(Identify, DoesNotPassAFailedFitForASuccess) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  const auto text = exact_beam();
  write("thesis_5x5.csv", set);
  (void)run(identify_command, text, "sound");
  EXPECT_TRUE(std::get<bool>(left("identified.json", "sound").at("trust").at("trusted").value()));
  EXPECT_TRUE(left("identified.json", "sound").at("trust").at("outlying").array().empty());
  spoil_one_value(set);
  write("thesis_5x5.csv", set);
  try {
    (void)run(identify_command, text, "failed");
    ADD_FAILURE() << "passed for a success";
  } catch (const NumericalFailure& e) {
    EXPECT_NE(std::string(e.what()).find("not to be trusted"), std::string::npos) << e.what();
  }
  const auto trust = left("identified.json", "failed").at("trust");
  EXPECT_FALSE(std::get<bool>(trust.at("trusted").value()));
  EXPECT_EQ(trust.at("verdict").string(), "not to be trusted");
  ASSERT_EQ(trust.at("outlying").array().size(), 1U);
  EXPECT_EQ(trust.at("outlying").array()[0].at("sensor").string(), "y3");
  EXPECT_EQ(trust.at("outlying").array()[0].at("actuator").string(), "u1");
  EXPECT_EQ(trust.at("outlying").array()[0].at("frequency_hz").number(), set.frequency_hz(700));
}

// A response that the first record lacks is a guess of the fit. It made a right model err 14 times
// the noise.
TEST_F(Identify, ScoresASecondRecordOnTheResponsesOfTheFirst) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  write("second.csv", set);
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    set.value[k](2, 1) = set.variance[k](2, 1) = std::nan("");
  }
  write("thesis_5x5.csv", set);
  const auto said = run(identify_command, replaced(exact_beam(), "[measurement]",
                                                   "[measurement]\nvalidation = \"second.csv\""));
  EXPECT_NE(said.find("lacks are left out of its score: y3/u2"), std::string::npos) << said;
  const auto score = left("identified.json").at("validation").at("second_record").at("whole");
  EXPECT_LT(score.at("residual_over_noise").number(), 1.5);
}

// The worst of many outlying lines stand first.
TEST_F(Identify, ListsTheWorstOfManyOutlyingLines) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  for (std::size_t k = 300; k < 700; k += 40) {
    set.value[k](2, 0) += (k == 660 ? 900.0 : 60.0) * std::sqrt(set.variance[k](2, 0));
  }
  write("thesis_5x5.csv", set);
  const auto study = study::parse_study(exact_beam(), folder_.path() / "study.toml");
  QuietRun quiet(study, folder_.path() / "out");
  try {
    identify_command.run(study, quiet.run());
  } catch (const NumericalFailure&) {  // or not: the list is shown either way
  }
  const auto said = quiet.shown() + quiet.said();
  const auto worst = said.find(fmt::format("outlying at {:.6g} Hz", set.frequency_hz(660)));
  ASSERT_NE(worst, std::string::npos) << said;
  EXPECT_EQ(worst, said.find("outlying at")) << said;
}

// The program prints its result and then fails.
TEST_F(Identify, PrintsAnUntrustedFitAndItsErrorAsOneObject) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  spoil_one_value(set);
  write("thesis_5x5.csv", set);
  const auto text = exact_beam();
  write_atomically(folder_.path() / "study.toml", text);
  const auto printed = folder_.path() / "printed.json";
  const auto line = CHLADNI_BINARY_DIR "/bin/chladni identify --json --quiet --no-pictures -o " +
                    (folder_.path() / "out").string() + " " +
                    (folder_.path() / "study.toml").string() + " 2>/dev/null >" + printed.string();
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 4);
  const auto json = io::parse_json(read_whole(printed));
  EXPECT_EQ(json.at("error").at("exit").number(), 4.0);
  EXPECT_FALSE(std::get<bool>(json.at("trust").at("trusted").value()));
}

const char* const kClampedPlate = R"(
geometry = { plate = { length = "300 mm", width = "200 mm", thickness = "8 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "25 mm", order = 2 }
modes = { count = 8, damping_ratio = 0.005 }
sensor = [
  { name = "s1", at = ["100 mm", "80 mm"], direction = "z" },
  { name = "s2", at = ["-110 mm", "80 mm"], direction = "z" },
  { name = "s3", at = ["-90 mm", "-70 mm"], direction = "z" }]
actuator = [
  { name = "a1", at = ["70 mm", "60 mm"], direction = "z" },
  { name = "a2", at = ["-110 mm", "80 mm"], direction = "z" }]
[measurement]
frf = "measured.csv"
[experiment]
noise = "0.1 nm"
band = ["100 Hz", "2200 Hz"]
sample_rate = "6 kHz"
samples = 4096
realisations = 4
periods = 4
warm_up = 2
[[support]]
patch = "x_min"
fixed = "xyz"
)";

// The noise is estimated from the first fit. The second, which started at poles anew, lost all
// modes but one.
TEST_F(Identify, KeepsTheModesThatTheFirstFitFound) {
  const std::string text = kClampedPlate;
  (void)run(simulate_command, text, "simulated");
  const auto file = folder_.path() / "measured.csv";
  auto set = io::read_frf(file, {.unit = "m"}).set;
  set.variance.clear();
  set.noise_variance.clear();
  set.averages = 0.0;
  write("measured.csv", set);
  (void)run(identify_command, text + "[identification]\nunit = \"m\"\n");
  const auto json = left("identified.json");
  EXPECT_TRUE(std::get<bool>(json.at("trust").at("trusted").value()));
  EXPECT_GE(json.at("modes").array().size(), 4U);
}

// Variances that are all 0 are none.
TEST_F(Identify, TakesVariancesOfZeroForNone) {
  const std::string text = kClampedPlate;
  (void)run(simulate_command, text, "simulated");
  auto set = io::read_frf(folder_.path() / "measured.csv", {.unit = "m"}).set;
  set.noise_variance.clear();
  set.averages = 0.0;
  for (auto& line : set.variance) line.setZero();
  write("measured.csv", set);
  (void)run(identify_command, text + "[identification]\nunit = \"m\"\n", "zeros");
  set.variance.clear();
  write("measured.csv", set);
  (void)run(identify_command, text + "[identification]\nunit = \"m\"\n", "none");
  EXPECT_EQ(left("identified.json", "zeros").at("fit").at("noise_floor").number(),
            left("identified.json", "none").at("fit").at("noise_floor").number());
}

TEST_F(Identify, NamesChannelsThatOnlyOneSideHas) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  set.outputs[2].name = "probe";
  write("thesis_5x5.csv", set);
  const auto said = run(identify_command, model("beam/thesis_5x5.toml"));
  EXPECT_NE(said.find("\"probe\" is no channel of the study"), std::string::npos) << said;
  EXPECT_EQ(left("identified.json").at("sensors").array().size(), 4U);
  for (std::size_t i = 0; i < 5; ++i) set.outputs[i].name = "probe" + std::to_string(i);
  write("thesis_5x5.csv", set);
  refused(model("beam/thesis_5x5.toml"), "no response between a sensor and an actuator");
}

TEST_F(Identify, SuspectsSwappedRows) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  const auto text = model("beam/thesis_5x5.toml");
  write("thesis_5x5.csv", set);
  const std::string suspicion = "it is not one place";
  EXPECT_EQ(run(identify_command, text).find(suspicion), std::string::npos);
  for (auto& value : set.value) value.row(0).swap(value.row(3));
  write("thesis_5x5.csv", set);
  EXPECT_NE(run(identify_command, text).find(suspicion), std::string::npos);
}

TEST_F(Identify, DoesWithoutLinesThatWereNotMeasured) {
  auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  for (std::size_t k = 100; k < 160; ++k) set.value[k].row(1).setConstant(NAN);
  for (std::size_t k = 300; k < 320; ++k) set.value[k].setConstant(NAN);
  write("thesis_5x5.csv", set);
  (void)run(identify_command, model("beam/thesis_5x5.toml"));
  expect_modes(left("identified.json"), truth(recordings::beam_with_coils(), 5));
}

TEST_F(Identify, RefusesWhatCannotBeMeant) {
  const auto text = model("beam/thesis_2x4.toml");
  refused(text, "thesis_5x5.csv");  // is not there
  const auto set = measured(recordings::beam_with_coils(), 5, {1, 2, 3, 4, 5});
  write("thesis_5x5.csv", set);
  const auto unit = [&](const std::string& other) {
    return replaced(text, "unit        = \"m\"", "unit = \"" + other + "\"");
  };
  refused(unit("m/s"), "the study says displacement");
  refused(replaced(text, "frf      = \"thesis_5x5.csv\"\n", ""), "frf");
  refused(replaced(text, "[\"y1\", \"y3\", \"y4\"]", "[\"y1\", \"y2\", \"y3\", \"y4\", \"y5\"]"),
          "leaves no sensor");
  write("thesis_5x5.csv", modal::band(set, 10.0, 11.0));
  refused(text, "lines");
  write("thesis_5x5.csv", modal::band(set, 10.0, 12.5));
  refused(replaced(with_real_modes(text), "[identification]\n",
                   "[identification]\nmodel_error = 0.003\nmodes = 40\n"),
          "numbers");
  write_atomically(folder_.path() / "thesis_5x5.csv",
                   "freq_hz,re_y1u1,im_y1u1,re_y2u1,im_y2u1\n1,2,3,4,5\n2,3,4\n");
  refused(text, "thesis_5x5.csv");  // a line that is too short
}

}  // namespace
}  // namespace chladni::app
