// Which responses of a universal file are a study's channels: node, axis and sign.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>
#include <tuple>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/json.h"
#include "io/time_file.h"
#include "steps/identification.h"
#include "steps/observer.h"
#include "tests/app/quiet_run.h"
#include "tests/io/measured/uff_samples.h"
#include "tests/refusal.h"

namespace chladni::app {
namespace {

constexpr Eigen::Index kLines = 400;  // each 1 Hz

// A response at 101 to a force at 7, −z, with one resonance.
io::Sample58 response(int direction, double resonance_hz, int node = 101) {
  io::Sample58 sample;
  sample.ordinate = 8;
  sample.unit = "m";
  sample.ordinate_type = 6;
  sample.response_node = node;
  sample.response_direction = direction;
  sample.reference_node = 7;
  sample.x.clear();
  sample.y.clear();
  for (Eigen::Index k = 0; k < kLines; ++k) {
    const double f = 1.0 + static_cast<double>(k);
    sample.x.push_back(f);
    const double w = f / resonance_hz;
    sample.y.push_back(1e-6 / std::complex<double>(1.0 - w * w, 0.02 * w));
  }
  return sample;
}

std::string triaxial() {
  return dataset_58(response(1, 100.0)) + dataset_58(response(2, 150.0)) +
         dataset_58(response(3, 250.0));
}

std::string sensor(const std::string& name, const std::string& direction, const std::string& node) {
  return "[[sensor]]\nname = \"" + name +
         "\"\nat = [\"-40 mm\", \"20 mm\"]\ndirection = " + direction + "\n" +
         (node.empty() ? "" : "node = " + node + "\n");
}

// A force along −z at node 7, as the files have it, so that only sensors are turned.
std::string study(const std::string& sensors, const std::string& actuator_direction = "\"-z\"") {
  return R"(geometry = { plate = { length = "100 mm", width = "60 mm", thickness = "5 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
[measurement]
frf = "measured.uff"
[identification]
rigid_body_modes = 0
modes = 1
)" + sensors +
         "[[actuator]]\nname = \"a1\"\nat = [\"40 mm\", \"20 mm\"]\nnode = 7\ndirection = " +
         actuator_direction + "\n";
}

class MeasuredChannels : public testing::Test {
 protected:
  steps::MeasuredFrfs read(const std::string& uff, const std::string& text) {
    write_atomically(folder_.path() / "measured.uff", uff);
    const study::Study study = study::parse_study(text, folder_.path() / "study.toml", {});
    std::ostringstream said;
    std::ostringstream shown;
    show::Talk talk(said, show::Manner{});
    show::Options options;
    options.folder = folder_.path() / "out";
    show::Run quiet(study, options, shown, talk);
    auto result = steps::measured_frfs(study, quiet);
    said_ = said.str();
    return result;
  }

  void refused(const std::string& uff, const std::string& text,
               const std::vector<std::string>& words) {
    try {
      (void)read(uff, text);
      ADD_FAILURE() << "taken; expected a refusal about " << words.front();
    } catch (const InvalidInput& e) {
      for (const auto& word : words) {
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << "\n" << e.what();
      }
    }
  }

  // Where the response of the first sensor is largest [Hz].
  static double peak(const steps::MeasuredFrfs& measured, Eigen::Index sensor = 0) {
    Eigen::Index at = 0;
    for (Eigen::Index k = 0; k < measured.all.line_count(); ++k) {
      const auto size = [&](Eigen::Index line) {
        return std::abs(measured.all.value[static_cast<std::size_t>(line)](sensor, 0));
      };
      if (size(k) > size(at)) at = k;
    }
    return measured.all.frequency_hz(at);
  }

  static double first_value(const steps::MeasuredFrfs& measured) {
    return measured.all.value[0](0, 0).real();
  }

  [[nodiscard]] bool says(const std::string& word) const {
    return said_.find(word) != std::string::npos;
  }

  TestFolder folder_{"measured_channels"};
  std::string said_;
};

// Responses to a drive's voltage are no responses to a force: who does not know it has wrong
// masses.
TEST_F(MeasuredChannels, AnInputThatIsNoForceIsNamed) {
  const auto text = study(sensor("s1", "\"z\"", "101"));
  auto sample = response(3, 100.0);
  for (const auto* force : {"N", "lbf", ""}) {
    sample.input_unit = force;
    (void)read(dataset_58(sample), text);
    EXPECT_FALSE(says("gain")) << force << "\n" << said_;
  }
  sample.input_unit = "V";
  (void)read(dataset_58(sample), text);
  EXPECT_TRUE(says("the input of \"a1\" is in V")) << said_;
  EXPECT_TRUE(says("the actuator's gain")) << said_;
}

TEST_F(MeasuredChannels, TheAxisDecidesAmongTheThreeOfANode) {
  const double resonances[] = {100.0, 150.0, 250.0};
  const char* axes[] = {"\"x\"", "\"y\"", "\"z\""};
  for (int axis = 0; axis < 3; ++axis) {
    const auto found = read(triaxial(), study(sensor("s1", axes[axis], "101")));
    EXPECT_EQ(peak(found), resonances[axis]) << axes[axis];
    EXPECT_GT(first_value(found), 0.0);
    EXPECT_EQ(found.all.outputs[0].name, "s1");
  }
  const auto all =
      read(triaxial(), study(sensor("sz", "\"z\"", "101") + sensor("sx", "\"x\"", "101") +
                             sensor("sy", "\"y\"", "101")));
  EXPECT_EQ(peak(all, 0), 250.0);
  EXPECT_EQ(peak(all, 1), 100.0);
  EXPECT_EQ(peak(all, 2), 150.0);
}

TEST_F(MeasuredChannels, AnObliqueFrameOfTheStudyIsNoObstacleToItsOwnAxes) {
  const auto found = read(triaxial(), study(sensor("s1", "[0, 0.002, 1]", "101")));
  EXPECT_EQ(peak(found), 250.0);  // a tenth of a degree is z
}

TEST_F(MeasuredChannels, AResponseAgainstTheStudysDirectionIsTurned) {
  const auto uff = dataset_58(response(1, 100.0)) + dataset_58(response(-3, 250.0));
  const auto turned = read(uff, study(sensor("s1", "\"z\"", "101")));
  EXPECT_EQ(peak(turned), 250.0);
  EXPECT_LT(first_value(turned), 0.0);
  EXPECT_TRUE(says("\"-101z\" (node 101, along (0, 0, -1)) is \"s1\" against its direction"));
  EXPECT_TRUE(says("\"101x\" is no channel of the study"));
  EXPECT_NEAR(first_value(turned), -first_value(read(uff, study(sensor("s1", "\"-z\"", "101")))),
              1e-18);
  EXPECT_FALSE(says("sign is turned"));
}

TEST_F(MeasuredChannels, AForceAgainstTheStudysDirectionIsTurned) {
  const auto same = read(triaxial(), study(sensor("s1", "\"z\"", "101")));
  const auto turned = read(triaxial(), study(sensor("s1", "\"z\"", "101"), "\"z\""));
  EXPECT_EQ(first_value(turned), -first_value(same));
  const auto both = read(triaxial(), study(sensor("s1", "\"-z\"", "101"), "\"z\""));
  EXPECT_EQ(first_value(both), first_value(same));
}

TEST_F(MeasuredChannels, ANameWithTheFilesDirectionAgainstTheStudyIsTurnedOrRefused) {
  const auto same = read(triaxial(), study(sensor("101z", "\"z\"", "")));
  const auto turned = read(triaxial(), study(sensor("101z", "\"-z\"", "")));
  EXPECT_EQ(first_value(turned), -first_value(same));
  refused(triaxial(), study(sensor("101x", "\"z\"", "")), {"101x", "along (1, 0, 0)", "(0, 0, 1)"});
}

TEST_F(MeasuredChannels, WhatIsAmbiguousIsRefusedWithItsCandidates) {
  const auto twice = dataset_58(response(3, 100.0)) + dataset_58(response(-3, 250.0));
  refused(twice, study(sensor("s1", "\"z\"", "101")),
          {"s1", "two channels of node 101 fit it", "\"101z\"", "\"-101z\""});
  refused(triaxial(), study(sensor("s1", "[1, 0, 1]", "101")),
          {"s1", "(0.7071, 0, 0.7071)", "\"101x\"", "\"101y\"", "\"101z\""});
  refused(dataset_58(response(0, 100.0)), study(sensor("s1", "\"z\"", "101")),
          {"s1", "\"101\" (node 101, without a direction)"});
  refused(dataset_58(response(6, 100.0)), study(sensor("s1", "\"z\"", "101")),
          {"\"101rz\" (node 101, without a direction)"});  // a rotation about z is not along it
  refused(triaxial(), study(sensor("s1", "\"z\"", "101") + sensor("s2", "\"-z\"", "101")),
          {"\"101z\"", "both \"s1\" and \"s2\""});
  const auto elsewhere = dataset_58(response(3, 100.0)) + dataset_58(response(3, 250.0, 102));
  refused(elsewhere, study(sensor("102z", "\"z\"", "101")),
          {"by its name and another by its node", "\"102z\"", "\"101z\""});
}

TEST_F(MeasuredChannels, AnAxisThatWasNotMeasuredIsLeftOut) {
  const auto uff = dataset_58(response(1, 100.0)) + dataset_58(response(3, 250.0));
  const auto found = read(uff, study(sensor("sy", "\"y\"", "101") + sensor("sz", "\"z\"", "101")));
  ASSERT_EQ(found.all.output_count(), 1);
  EXPECT_EQ(found.all.outputs[0].name, "sz");
  EXPECT_EQ(peak(found), 250.0);
  EXPECT_TRUE(says("\"sy\" was not measured"));
  EXPECT_TRUE(says("at node 101 only \"101x\" (node 101, along (1, 0, 0)), \"101z\""));
}

TEST_F(MeasuredChannels, OtherMotionsThanDisplacementsNeedAUnit) {
  auto sample = response(3, 250.0);
  sample.ordinate = 0;
  sample.label = "Response";
  sample.unit = "NONE";
  const auto unitless = dataset_58(sample);
  const auto with = [&](const std::string& quantity, const std::string& unit) {
    auto text = study(sensor("s1", "\"z\"", "101") + "quantity = \"" + quantity + "\"\n");
    const std::string key = "[identification]\n";
    return text.insert(text.find(key) + key.size(),
                       unit.empty() ? "" : "unit = \"" + unit + "\"\n");
  };
  refused(
      unitless, with("acceleration", ""),
      {"\"s1\" measures acceleration, and no unit is stated", "[identification] unit = \"m/s^2\""});
  refused(unitless, with("velocity", ""), {"[identification] unit = \"m/s\""});
  const auto si = read(unitless, with("acceleration", "m/s^2"));
  const auto g = read(unitless, with("acceleration", "g"));
  EXPECT_NEAR(first_value(g) / first_value(si), 9.80665, 1e-9);
  EXPECT_EQ(si.all.outputs[0].kind, modal::FrfKind::accelerance);
  EXPECT_EQ(first_value(read(unitless, with("displacement", ""))), first_value(si));
}

// Accelerations were fitted as displacements where the file states their type and no unit.
TEST_F(MeasuredChannels, TheTypeOfTheDataCountsWithoutAUnit) {
  auto sample = response(3, 250.0);
  sample.unit = "NONE";
  const std::string unitless = study(sensor("s1", "\"z\"", "101"));
  for (const auto& [type, quantity, unit] :
       {std::tuple(11, "velocity", "m/s"), std::tuple(12, "acceleration", "m/s^2")}) {
    sample.ordinate = type;
    refused(dataset_58(sample), unitless,
            {std::string("\"s1\" is of ") + quantity + " as the file says",
             std::string("[identification] unit = \"") + unit + "\""});
  }
  sample.ordinate = 8;
  EXPECT_EQ(read(dataset_58(sample), unitless).all.outputs[0].kind, modal::FrfKind::receptance);
  EXPECT_TRUE(says("the unit of"));
}

// What `simulate` and `convert` write of sensors that differ could not be read back.
TEST_F(MeasuredChannels, ATableOfSeveralQuantitiesIsReadBack) {
  write_atomically(folder_.path() / "measured.uff", dataset_58(response(3, 250.0)));
  auto set = io::read_frf(folder_.path() / "measured.uff").set;
  set.inputs[0].name = "a1";
  set.outputs = {set.outputs[0], set.outputs[0]};
  set.outputs[0].name = "s1";
  set.outputs[1].name = "s2";
  set.outputs[1].kind = modal::FrfKind::accelerance;
  set.outputs[1].unit = "m/s^2";
  for (auto& line : set.value) line = line.replicate(2, 1).eval();
  const auto lost = io::write_frf(folder_.path() / "measured.csv", set);
  ASSERT_FALSE(lost.empty());
  EXPECT_NE(lost.front().find("say unit = \"SI\""), std::string::npos) << lost.front();
  auto text = study(sensor("s1", "\"z\"", "") + sensor("s2", "\"z\"", "") +
                    "quantity = \"acceleration\"\n");
  text.replace(text.find("measured.uff"), 12, "measured.csv");
  refused("", text, {"\"s2\" measures acceleration", "\"SI\" where sensors differ"});
  const std::string key = "[identification]\n";
  const auto found = read("", text.insert(text.find(key) + key.size(), "unit = \"SI\"\n")).all;
  ASSERT_EQ(found.output_count(), 2);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found.outputs[i].kind, set.outputs[i].kind);
    EXPECT_EQ(found.outputs[i].unit, set.outputs[i].unit);
  }
  EXPECT_EQ(found.value[7], set.value[7]);
}

// An observer ran over accelerations as if they were displacements.
TEST_F(MeasuredChannels, RecordingsAreOfTheStudysQuantity) {
  recordings::TimeData data;
  data.outputs.push_back({.name = "s1"});
  data.inputs.push_back({.name = "a1"});
  data.sample_time_s = 1e-3;
  data.records.push_back({.outputs = Eigen::MatrixXd::Ones(16, 1),
                          .inputs = Eigen::MatrixXd::Ones(16, 1),
                          .references = Eigen::MatrixXd(16, 0)});
  steps::IdentifiedModel model;
  model.seen.outputs = data.outputs;
  model.seen.inputs = data.inputs;
  const auto read = [&](const std::string& unit, modal::FrfKind kind) {
    data.outputs[0].unit = unit;
    data.outputs[0].kind = kind;
    (void)io::write_time(folder_.path() / "recorded.uff", data);
    auto text = study(sensor("s1", "\"z\"", ""));
    text.replace(text.find("frf = \"measured.uff\""), 20, "time = \"recorded.uff\"");
    stage::Work work;
    return steps::recordings(study::parse_study(text, folder_.path() / "study.toml", {}), model,
                             work);
  };
  EXPECT_EQ(read("m", modal::FrfKind::receptance).records.size(), 1U);
  EXPECT_EQ(read("", modal::FrfKind::receptance).records.size(), 1U);
  for (const char* unit : {"m/s^2", ""}) {
    EXPECT_NE(
        refusal_of([&] { return read(unit, modal::FrfKind::accelerance); }).find("acceleration"),
        std::string::npos)
        << unit;
  }
}

TEST_F(MeasuredChannels, AUnitThatIsOfNoMotionIsRefused) {
  auto sample = response(3, 250.0);
  sample.ordinate = 0;
  sample.unit = "NONE";
  const auto unitless = dataset_58(sample);
  const auto with = [&](const std::string& unit) {
    auto text = study(sensor("s1", "\"z\"", "101"));
    const std::string key = "[identification]\n";
    return text.insert(text.find(key) + key.size(), "unit = \"" + unit + "\"\n");
  };
  refused(unitless, with("V"),
          {"\"s1\" is measured in \"V\", and the study says displacement", "expected \"m\" or"});
  refused(unitless, with("kg"), {"the unit \"kg\" is none that is known"});
  refused(unitless, with("foo"), {"the unit \"foo\" is none that is known"});
  sample.unit = "V";
  refused(dataset_58(sample), study(sensor("s1", "\"z\"", "101")),
          {"\"s1\" is measured in \"V\"", "`chladni convert` to .csv"});
}

TEST_F(MeasuredChannels, TheFitIsThatOfTheStudysAxis) {
  write_atomically(folder_.path() / "measured.uff", triaxial());
  const study::Study plate =
      study::parse_study(study(sensor("s1", "\"z\"", "101")), folder_.path() / "study.toml", {});
  QuietRun quiet(plate, folder_.path() / "out");
  identify_command.run(plate, quiet.run());
  const auto json = io::parse_json(read_whole(folder_.path() / "out/identified.json"));
  ASSERT_EQ(json.at("modes").array().size(), 1U);
  EXPECT_NEAR(json.at("modes").array()[0].at("frequency_hz").number(), 250.0, 0.1);
}

}  // namespace
}  // namespace chladni::app
