// Modes of files on a study's channels, and the diagnosis of a study by them alone.
#include "steps/measured_modes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "base/error.h"
#include "io/json.h"
#include "io/shape_table.h"
#include "rotation/turn.h"
#include "show/diagnosis.h"
#include "steps/diagnosis.h"
#include "steps/identification.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::steps {
namespace {

using diagnosis::Verdict;

// A steel plate that no symmetry makes blind.
const std::string kStudy =
    R"(geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }
material = { youngs_modulus = "MODULUS GPa", poissons_ratio = 0.3, density = "7850 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 20, damping_ratio = 0.01 }
measurement = { modes = "FILE" }
[[sensor]]
name = "s1"
at = ["-250 mm", "150 mm"]
direction = "z"
node = 11
[[sensor]]
name = "s2"
at = ["110 mm", "40 mm"]
direction = "-z"
node = 12
[[sensor]]
name = "s3"
at = ["240 mm", "-170 mm"]
direction = "z"
[[sensor]]
name = "s4"
at = ["-90 mm", "-60 mm"]
direction = "z"
[[sensor]]
name = "s5"
at = ["40 mm", "180 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["-170 mm", "-120 mm"]
direction = "z"
)";

const std::string kMass = R"([[attachment]]
kind = "mass"
name = "forgotten"
at = ["150 mm", "90 mm"]
mass = "0.8 kg"
)";

std::string replaced(std::string text, const std::string& mark, const std::string& by) {
  return text.replace(text.find(mark), mark.size(), by);
}

class MeasuredModes : public testing::Test {
 protected:
  study::Study study_of(const std::string& file, const std::string& more = "",
                        const std::string& modulus = "210") {
    const auto path = folder_.path() / "study.toml";
    std::ofstream(path) << replaced(replaced(kStudy, "MODULUS", modulus), "FILE", file) << more;
    return study::read_study(path);
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  diagnosis::MeasuredModes read(const study::Study& study) const {
    stage::Work work;
    return measured_modes(study, work);
  }

  // The message with which the file is refused.
  std::string refusal(const std::string& name, const std::string& text) {
    if (!text.empty()) write(name, text);
    return refusal_of([&] { return read(study_of(name)); });
  }

  // A table of the first modes of another plate at the channels, with errors as a test has them.
  void write_modes(const study::Study& real, int count, bool with_shapes,
                   const std::string& name = "modes.csv", unsigned seed = 3) const {
    stage::Work work;
    const auto solution = stage::solved(real, work);
    const auto rigid = solution.modes.rigid_count;
    io::ShapeTable table;
    std::mt19937 dice(seed);
    std::normal_distribution<double> normal;
    table.frequency_hz = solution.modes.frequency_hz.segment(rigid, count);
    for (double& hz : table.frequency_hz) hz *= 1.0 + 1e-3 * normal(dice);
    table.damping_ratio = Eigen::VectorXd::Constant(count, 0.01);
    for (double& ratio : table.damping_ratio) ratio *= std::exp(0.1 * normal(dice));
    if (with_shapes) {
      table.channels = study::names_of(real.sensors);
      table.values = stage::shapes_at(real.sensors, solution.model.sensors, solution.modes)
                         .middleCols(rigid, count);
      const double rms =
          std::sqrt(table.values.squaredNorm() / static_cast<double>(table.values.size()));
      for (double& value : table.values.reshaped()) value += 0.01 * rms * normal(dice);
    } else {
      table.values.resize(0, count);
    }
    table.deviation.setZero(table.values.rows(), count);
    io::write_shapes(folder_.path() / name, table);
  }

  steps::Diagnosed diagnosed_of(const study::Study& study) {
    app::QuietRun quiet(study, folder_.path() / "out");
    auto result = steps::diagnosed(study, quiet.run());
    shown_ = show::diagnosis_table(result);
    show::leave_diagnosis(study, result, quiet.run(), false);
    return result;
  }

  io::Json left() const {
    std::ifstream file(folder_.path() / "out/diagnosis.json");
    std::ostringstream text;
    text << file.rdbuf();
    return io::parse_json(text.str());
  }

  std::string shown_;
  app::TestFolder folder_{"measured_modes"};
};

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(MeasuredModes, AreReadFromATableWithGaps) {
  write("modes.csv",
        "frequency_hz,std_frequency_hz,damping_ratio,s1,s2,std_s2,a1\n"
        "200,2,0.02,1,,,3\n100,,,4,5,0.5,6\n0,,,1,1,1,1\n");
  const auto modes = read(study_of("modes.csv"));
  ASSERT_EQ(modes.count(), 2);
  EXPECT_EQ(modes.outputs, (std::vector<std::string>{"s1", "s2"}));
  EXPECT_EQ(modes.inputs, std::vector<std::string>{"a1"});
  EXPECT_EQ(modes.frequency_hz, Eigen::Vector2d(100.0, 200.0));
  EXPECT_EQ(modes.frequency_std, Eigen::Vector2d(0.0, 0.01));
  EXPECT_TRUE(std::isnan(modes.damping_ratio(0)));
  EXPECT_EQ(modes.damping_ratio(1), 0.02);
  EXPECT_EQ(modes.output_shapes(1, 0), std::complex<double>(5.0));
  EXPECT_TRUE(std::isnan(modes.output_shapes(1, 1).real()));
  EXPECT_EQ(modes.output_std(1, 0), 0.5);
  EXPECT_DOUBLE_EQ(modes.output_std(0, 1), 0.01);  // 1 % of the one value
  EXPECT_FALSE(modes.scaled);
}

// Its channel has deviations in other modes: whoever wrote the table may not know the value.
TEST_F(MeasuredModes, WarnOfAValueThatLacksItsDeviation) {
  const auto said_of = [&](const std::string& table) {
    write("modes.csv", table);
    const auto study = study_of("modes.csv");
    app::QuietRun quiet(study, folder_.path() / "out");
    (void)measured_modes(study, quiet.run());
    return quiet.said();
  };
  const auto doubtful = said_of("frequency_hz,s1,std_s1,s2\n100,1,0.1,3\n200,0,,4\n300,,,5\n");
  EXPECT_TRUE(says(doubtful, "without a deviation at channels that have others: 1;")) << doubtful;
  const auto clear = said_of("frequency_hz,s1,std_s1,s2\n100,1,0.1,3\n200,,,4\n");
  EXPECT_FALSE(says(clear, "without a deviation")) << clear;
}

TEST_F(MeasuredModes, OfFrequenciesAloneNeedNoChannel) {
  write("modes.csv", "# from a paper\nfrequency_hz\n12.5\n20\n");
  const auto modes = read(study_of("modes.csv"));
  EXPECT_EQ(modes.frequency_hz, Eigen::Vector2d(12.5, 20.0));
  EXPECT_TRUE(modes.outputs.empty());
}

TEST_F(MeasuredModes, LieWithinTheBandAndWithoutWhatIsHeldOut) {
  write("modes.csv", "frequency_hz,s1,s2\n10,1,1\n100,2,3\n1000,1,1\n");
  auto study = study_of("modes.csv", "[diagnosis]\nband = [\"50 Hz\", \"500 Hz\"]\n");
  study.measurement->hold_out = {"s1"};
  const auto modes = read(study);
  ASSERT_EQ(modes.count(), 1);
  EXPECT_EQ(modes.outputs, std::vector<std::string>{"s2"});
  EXPECT_EQ(modes.output_shapes(0, 0), std::complex<double>(3.0));
}

// Dataset 55: two nodes, three real translations each.
std::string dataset_55(double hz, const std::string& nodes) {
  return fmt::format(
      "    -1\n    55\nNONE\nNONE\nNONE\nNONE\nNONE\n         1         2         2         8"
      "         2         3\n         2         4         1         1\n"
      "{:13.5E}  1.00000E+00  1.00000E-02  0.00000E+00\n{}    -1\n",
      hz, nodes);
}

TEST_F(MeasuredModes, AreReadAtTheNodesOfAUniversalFile) {
  const std::string nodes =
      "        11\n  0.00000E+00  0.00000E+00  2.00000E+00\n"
      "        12\n  0.00000E+00  0.00000E+00  3.00000E+00\n";
  write("modes.unv", dataset_55(100.0, nodes) + dataset_55(50.0, nodes));
  const auto modes = read(study_of("modes.unv"));
  EXPECT_EQ(modes.frequency_hz, Eigen::Vector2d(50.0, 100.0));
  EXPECT_EQ(modes.damping_ratio, Eigen::Vector2d(0.01, 0.01));
  EXPECT_EQ(modes.outputs, (std::vector<std::string>{"s1", "s2"}));
  EXPECT_EQ(modes.output_shapes(0, 0), std::complex<double>(2.0));
  EXPECT_EQ(modes.output_shapes(1, 0), std::complex<double>(-3.0));  // s2 looks along -z
}

// A sensor at a node that the first mode lacks was left out of all modes, without a word.
TEST_F(MeasuredModes, OfAUniversalFileMayLackNodes) {
  const std::string first = "        11\n  0.00000E+00  0.00000E+00  2.00000E+00\n";
  const std::string second = "        12\n  0.00000E+00  0.00000E+00  3.00000E+00\n";
  write("modes.unv", dataset_55(50.0, first) + dataset_55(100.0, first + second));
  const auto study = study_of("modes.unv");
  std::ostringstream said;
  std::ostringstream shown;
  show::Talk talk(said, show::Manner{});
  show::Options options;
  options.folder = folder_.path() / "out";
  show::Run run(study, options, shown, talk);
  const auto modes = measured_modes(study, run);
  EXPECT_EQ(modes.outputs, (std::vector<std::string>{"s1", "s2"}));
  EXPECT_TRUE(std::isnan(modes.output_shapes(1, 0).real()));
  EXPECT_EQ(modes.output_shapes(1, 1), std::complex<double>(-3.0));
  EXPECT_PRED2(says, said.str(), "\"s3\", \"s4\", \"s5\" are at no node of it");
}

TEST_F(MeasuredModes, OfASensorCalledByNodeAndAxisAreAlongThatAxis) {
  const std::string nodes = "        26\n  1.00000E+00  0.00000E+00  2.00000E+00\n";
  const auto study_with = [&](const std::string& name, const std::string& direction) {
    return study_of("modes.unv", "[[sensor]]\nname = \"" + name +
                                     "\"\nat = [\"0.1 m\", \"0.1 m\", \"0 m\"]\ndirection = \"" +
                                     direction + "\"\n");
  };
  write("modes.unv", dataset_55(100.0, nodes));
  EXPECT_EQ(read(study_with("26z", "z")).output_shapes(0, 0), std::complex<double>(2.0));
  EXPECT_EQ(read(study_with("26z", "-z")).output_shapes(0, 0), std::complex<double>(-2.0));
  EXPECT_EQ(read(study_with("26x", "x")).output_shapes(0, 0), std::complex<double>(1.0));
  EXPECT_PRED2(says, refusal_of([&] { return read(study_with("26z", "x")); }),
               "\"26z\" is along (0, 0, 1) by its name and along (1, 0, 0) in the study");
}

TEST_F(MeasuredModes, AreReadFromWhatIdentifyLeaves) {
  write("identified.json", R"({"damping": "modal", "sensors": ["s1", "s2"], "actuators": ["a1"],
 "modes": [
 {"frequency_hz": 0, "damping_ratio": 0, "frequency_std_hz": 0, "damping_std": 0, "rigid": true},
 {"frequency_hz": 80, "damping_ratio": 0.01, "frequency_std_hz": 0.08, "damping_std": 0.001,
  "rigid": false}],
 "output_matrix": [[1, 2], [1, 3]], "output_std": [[0.1, 0.1], [0.1, null]],
 "input_matrix": [[1], [4]], "input_std": [[0.1], [0.2]]})");
  const auto modes = read(study_of("identified.json"));
  ASSERT_EQ(modes.count(), 1);
  EXPECT_EQ(modes.frequency_hz(0), 80.0);
  EXPECT_DOUBLE_EQ(modes.frequency_std(0), 0.001);
  EXPECT_DOUBLE_EQ(modes.damping_std(0), 0.1);
  EXPECT_EQ(modes.output_shapes(0, 0), std::complex<double>(2.0));
  EXPECT_TRUE(std::isnan(modes.output_shapes(1, 0).real()));
  EXPECT_EQ(modes.input_std(0, 0), 0.2);
  EXPECT_TRUE(modes.scaled);
}

TEST_F(MeasuredModes, AreRefusedByFileAndPlace) {
  EXPECT_PRED2(says, refusal("none.csv", ""), "none.csv: there is no such file");
  EXPECT_PRED2(says, refusal("modes.txt", "1"), "modes.txt: modes are read from .csv");
  EXPECT_PRED2(says, refusal("modes.csv", "frequency_hz\n"), "modes.csv: no mode");
  EXPECT_PRED2(says, refusal("modes.csv", "frequency_hz\n0\n"), "no mode above 0 Hz");
  EXPECT_PRED2(says, refusal("modes.csv", "frequency_hz,top\n10,1\n"), "'top' is no sensor");
  EXPECT_PRED2(says, refusal("modes.csv", "frequency_hz,s1\n10,x\n"), "modes.csv: line 2: s1");
  EXPECT_PRED2(says, refusal("a.uff", "    -1\n   151\na\nb\n    -1\n"), "no mode shape");
  EXPECT_PRED2(says, refusal("b.unv", "    -1\n  2414\n1\n    -1\n"),
               "b.unv: dataset 2414 (from line 2), line 4");
  EXPECT_PRED2(says, refusal("c.unv", dataset_55(9.0, "        77\n  0.  0.  1.\n")),
               "no sensor of the study is at a node");
  EXPECT_PRED2(says, refusal("d.json", "{\"verdict\": 1}"), "expected the identified.json");
}

TEST_F(MeasuredModes, NameAMassThatTheStudyLacks) {
  EVERY_FOURTH_LANDING();
  write_modes(study_of("modes.csv", kMass), 8, true);
  const auto one = diagnosed_of(study_of("modes.csv"));
  EXPECT_EQ(one.result.verdict, Verdict::named) << shown_;
  ASSERT_EQ(one.result.best.causes.size(), 1U) << shown_;
  EXPECT_EQ(one.result.best.causes.front().effect, "point_mass") << shown_;
  ASSERT_TRUE(one.extended && one.after) << shown_;
  for (const auto& mode : one.result.modes) {
    EXPECT_NEAR(mode.after_hz, mode.measured_hz, 0.02 * mode.measured_hz) << shown_;
    EXPECT_GT(mode.mac_after, 0.99) << shown_;
  }
  EXPECT_TRUE(says(shown_, "after: the finite elements of extended.toml")) << shown_;
  const auto json = left();
  EXPECT_EQ(json.at("verdict").string(), "named");
  EXPECT_EQ(json.at("modes").array().size(), 8U);
  EXPECT_GT(json.at("levels").at("frequency").at("at_most").number(), 0.0);
  EXPECT_TRUE(json.at("discrepancy").value().index() == 0);
  EXPECT_TRUE(json.at("gain").at("pays").value().index() == 0);
}

// A study that extends another says that it is not sure of the modulus.
TEST_F(MeasuredModes, CalibrateAConstantThatIsNotKnown) {
  write_modes(study_of("modes.csv", "", "235"), 8, true);
  static_cast<void>(study_of("modes.csv"));
  write("unsure.toml",
        "extends = \"study.toml\"\n"
        "material.youngs_modulus = { value = \"210 GPa\", within = \"15 %\" }\n");
  const auto one = diagnosed_of(study::read_study(folder_.path() / "unsure.toml"));
  EXPECT_EQ(one.result.verdict, Verdict::no_discrepancy) << shown_;
  ASSERT_EQ(one.result.constants.size(), 1U) << shown_;
  const auto& modulus = one.result.constants.front();
  EXPECT_NEAR(modulus.value, 235e9, 2.0 * modulus.std) << shown_;
  EXPECT_LT(modulus.std, 3e9) << shown_;
  EXPECT_TRUE(says(shown_, "material.youngs_modulus: 23")) << shown_;
  EXPECT_TRUE(says(shown_, "study: 210 GPa within 15 %")) << shown_;
  EXPECT_TRUE(says(shown_, "Beyond constants that were not known")) << shown_;
  EXPECT_EQ(left().at("constants").array().size(), 1U);
  ASSERT_TRUE(one.extended && one.after) << shown_;
  EXPECT_TRUE(says(one.extended->text, "within = \"15 %\"")) << one.extended->text;
  for (const auto& mode : one.result.modes) {
    EXPECT_NEAR(mode.after_hz, mode.measured_hz, 0.01 * mode.measured_hz) << shown_;
    EXPECT_LT(mode.before_hz, 0.97 * mode.measured_hz) << shown_;
  }
}

// The study is 10 % too stiff, before and after.
TEST_F(MeasuredModes, NameWhatChangedSinceTheReference) {
  const std::string both = "after.csv\", reference = \"before.csv";
  write_modes(study_of("after.csv", kMass, "189"), 8, true, "after.csv", 4);
  write_modes(study_of("before.csv", "", "189"), 8, true, "before.csv", 5);
  const auto one = diagnosed_of(study_of(both));
  EXPECT_EQ(one.result.verdict, Verdict::named) << shown_;
  ASSERT_EQ(one.result.best.causes.size(), 1U) << shown_;
  EXPECT_EQ(one.result.best.causes.front().effect, "point_mass") << shown_;
  EXPECT_TRUE(one.extended && !one.after) << shown_;
  EXPECT_TRUE(says(shown_, "compared with before.csv: 8 of 8 modes are in both")) << shown_;
  EXPECT_TRUE(says(shown_, "Before and after, frequencies agree to")) << shown_;
  const auto json = left();
  EXPECT_EQ(json.at("reference").string(), "before.csv");
  EXPECT_GT(json.at("modes").array().front().at("reference_hz").number(), 0.0);
}

TEST_F(MeasuredModes, AreRefusedBesideAnotherReference) {
  write("after.csv", "frequency_hz,s1,s2\n100,1,2\n");
  write("others.csv", "frequency_hz,s3,s4\n100,1,2\n");
  write("far.csv", "frequency_hz,s1,s2\n900,1,2\n");
  const auto refused = [&](const std::string& file) -> std::string {
    stage::Work work;
    const auto study = study_of("after.csv\", reference = \"" + file);
    try {
      static_cast<void>(reference_modes(study, measured_modes(study, work), work));
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_PRED2(says, refused("others.csv"), "no sensor in common");
  EXPECT_PRED2(says, refused("far.csv"), "no mode in common");
  EXPECT_PRED2(says, refused("none.csv"), "none.csv: there is no such file");
}

TEST_F(MeasuredModes, OfTheStudyItselfAskForNothing) {
  write_modes(study_of("modes.csv"), 6, false);
  const auto one = diagnosed_of(study_of("modes.csv"));
  EXPECT_EQ(one.result.verdict, Verdict::no_discrepancy) << shown_;
  EXPECT_FALSE(one.extended);
  EXPECT_TRUE(std::isnan(one.result.modes.front().mac_before));
}

using MeasuredRecordings = MeasuredModes;

// Without a period they are blows of a hammer.
TEST_F(MeasuredRecordings, OfOneSideAreRefusedByTheirFile) {
  const std::pair<const char*, const char*> wrong[] = {
      {"time_s,a1\n0,1\n1,2\n", "no output (sensor) among the channels, 1 input"},
      {"time_s,s1\n0,1\n1,2\n", "no input (force, command) among the channels, 1 output"},
      {"time_s,period,a1\n0,0,1\n1,0,2\n2,0,3\n3,0,1\n", "no output (sensor)"}};
  for (const auto& [text, what] : wrong) {
    write("recorded.csv", text);
    auto study = study_of("modes.csv");
    study.measurement->modes_file.clear();
    study.measurement->time = folder_.path() / "recorded.csv";
    stage::Work work;
    const auto found = refusal_of([&] { return measured_frfs(study, work); });
    EXPECT_PRED2(says, found, std::string("recorded.csv: ") + what);
  }
}

}  // namespace
}  // namespace chladni::steps
