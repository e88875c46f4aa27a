// Coordinate systems of universal files, datasets 18 and 2420, by hand after the format.
#include "io/uff/uff_systems.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "base/error.h"
#include "io/time_file.h"
#include "io/uff/frf_uff.h"
#include "io/uff/time_uff.h"
#include "tests/io/measured/uff_samples.h"
#include "tests/io/measured/written_uff.h"

namespace chladni::io {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string dataset(const std::string& number, const std::string& body) {
  return "    -1\n" + fmt::format("{:>6}", number) + "\n" + body + "    -1\n";
}

// 5I10, a name, 1P6E13.5 on two lines.
std::string system_18(int number, int type, int reference, const Vector3d& origin,
                      const Vector3d& on_x, const Vector3d& in_xz) {
  std::string text =
      fmt::format("{:10}{:10}{:10}{:10}{:10}\nCS{}\n", number, type, reference, 8, 1, number);
  for (const auto* point : {&origin, &on_x}) {
    for (const double c : *point) text += fmt::format("{:13.5E}", c);
  }
  text += "\n";
  for (const double c : in_xz) text += fmt::format("{:13.5E}", c);
  return text + "\n";
}

// A part's number and name, then 3I10, a name, the matrix in four rows of 1P3D25.16.
std::string system_2420(int number, int type, const Matrix3d& axes_in_rows,
                        const Vector3d& origin) {
  std::string text =
      fmt::format("{:10}\nPart1\n{:10}{:10}{:10}\nCS{}\n", 1, number, type, 8, number);
  for (int row = 0; row < 4; ++row) {
    const Vector3d numbers = row < 3 ? Vector3d(axes_in_rows.row(row)) : origin;
    for (const double c : numbers) text += fmt::format("{:25.16E}", c);
    text += "\n";
  }
  std::replace(text.begin(), text.end(), 'E', 'D');
  return text;
}

std::string node_15(int node, int place, int displacement, const Vector3d& at) {
  std::string text = fmt::format("{:10}{:10}{:10}{:10}", node, place, displacement, 11);
  for (const double c : at) text += fmt::format("{:13.5E}", c);
  return text + "\n";
}

std::string node_2411(int node, int place, int displacement, const Vector3d& at) {
  std::string text = fmt::format("{:10}{:10}{:10}{:10}\n", node, place, displacement, 11);
  for (const double c : at) text += fmt::format("{:25.16E}", c);
  return text + "\n";
}

// The response of node 12 in its z, to a force at node 3 along −z.
FrfFile read(const std::string& geometry, int direction = 3) {
  Sample58 sample;
  sample.response_direction = direction;
  return parse_frf_uff(dataset_164(1.0, 1.0) + geometry + dataset_58(sample), "t.uff");
}

Matrix3d turn() {
  return (Eigen::AngleAxisd(0.4, Vector3d::UnitX()) * Eigen::AngleAxisd(1.1, Vector3d::UnitZ()))
      .toRotationMatrix();
}

TEST(UffSystems, OneOf18TurnsTheDirectionsOfItsNodes) {
  const Matrix3d axes = turn();  // in columns
  const Vector3d origin(0.1, 0.2, -0.3);
  const auto geometry = dataset("18", system_18(5, 0, 0, origin, origin + 2.0 * axes.col(0),
                                                origin + 0.5 * axes.col(0) + 3.0 * axes.col(2))) +
                        dataset("15", node_15(12, 0, 5, Vector3d(1.0, 2.0, 3.0)) +
                                          node_15(3, 0, 0, Vector3d::Zero()));
  for (const int direction : {1, 2, 3, -1, -2, -3}) {
    const auto file = read(geometry, direction);
    const Vector3d expected = (direction > 0 ? 1.0 : -1.0) * axes.col(std::abs(direction) - 1);
    EXPECT_LT((file.set.outputs[0].direction - expected).norm(), 2e-5) << direction;
    EXPECT_EQ(file.set.inputs[0].direction, Vector3d(0.0, 0.0, -1.0));
    EXPECT_LT((*file.set.outputs[0].position - Vector3d(1.0, 2.0, 3.0)).norm(), 1e-12);
    EXPECT_EQ(times(file.notes, "is turned into the global"), 1);
  }
}

TEST(UffSystems, OneOf2420HasItsAxesInTheRows) {
  const Matrix3d axes = turn();
  const auto geometry =
      dataset("2420", system_2420(2, 0, axes.transpose(), Vector3d(1.0, 0.0, 0.0))) +
      dataset("2411", node_2411(12, 2, 2, Vector3d(1.0, 2.0, 3.0)));
  const auto file = read(geometry);
  EXPECT_LT((file.set.outputs[0].direction - axes.col(2)).norm(), 1e-12);
  // 2411: places are in the frame of the part, whatever system the node exports.
  EXPECT_LT((*file.set.outputs[0].position - Vector3d(1.0, 2.0, 3.0)).norm(), 1e-12);
}

TEST(UffSystems, TheOrderOfDatasetsDoesNotMatter) {
  const auto systems = dataset("2420", system_2420(2, 0, turn().transpose(), Vector3d::Zero()));
  const auto nodes = dataset("2411", node_2411(12, 0, 2, Vector3d::Ones()));
  EXPECT_EQ(read(systems + nodes).set.outputs[0].direction,
            read(nodes + systems).set.outputs[0].direction);
}

TEST(UffSystems, PlacesOf15AreInTheirOwnSystem) {
  const Matrix3d axes = turn();
  const Vector3d origin(0.5, 0.0, 1.0);
  const Vector3d at(1.0, 2.0, 3.0);
  const auto file =
      read(dataset("18", system_18(4, 0, 0, origin, origin + axes.col(0), origin + axes.col(2))) +
           dataset("15", node_15(12, 4, 0, at)));
  EXPECT_LT((*file.set.outputs[0].position - (origin + axes * at)).norm(), 1e-4);
  EXPECT_EQ(file.set.outputs[0].direction, Vector3d::UnitZ());
}

TEST(UffSystems, ACylinderHasOtherAxesAtEachNode) {
  const double angle = 30.0 * std::numbers::pi / 180.0;
  const Vector3d at(0.2 * std::cos(angle), 0.2 * std::sin(angle), 0.7);
  const auto geometry =
      dataset("18", system_18(2, 1, 0, Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitZ()));
  const auto by_place = geometry + dataset("15", node_15(12, 0, 2, at));
  const Vector3d radial(std::cos(angle), std::sin(angle), 0.0);
  const Vector3d tangential(-std::sin(angle), std::cos(angle), 0.0);
  EXPECT_LT((read(by_place, 1).set.outputs[0].direction - radial).norm(), 1e-5);
  EXPECT_LT((read(by_place, -2).set.outputs[0].direction + tangential).norm(), 1e-5);
  EXPECT_EQ(read(by_place, 3).set.outputs[0].direction, Vector3d::UnitZ());
  const auto cylindrical = geometry + dataset("15", node_15(12, 2, 2, Vector3d(0.2, 30.0, 0.7)));
  const auto file = read(cylindrical, 1);
  EXPECT_LT((file.set.outputs[0].direction - radial).norm(), 1e-5);
  EXPECT_LT((*file.set.outputs[0].position - at).norm(), 1e-5);
}

TEST(UffSystems, OneMayStandInAnother) {
  const Matrix3d turned = turn();
  const Matrix3d in_it = Eigen::AngleAxisd(0.7, Vector3d::UnitY()).toRotationMatrix();
  const auto geometry =
      dataset("18", system_18(2, 0, 1, Vector3d::Ones(), Vector3d::Ones() + in_it.col(0),
                              Vector3d::Ones() + in_it.col(2)) +
                        system_18(1, 0, 0, Vector3d::Zero(), turned.col(0), turned.col(2))) +
      dataset("15", node_15(12, 0, 2, Vector3d::Zero()));
  EXPECT_LT((read(geometry).set.outputs[0].direction - turned * in_it.col(2)).norm(), 1e-4);
}

TEST(UffSystems, NumberOneIsTheGlobalFrameWhereNothingIsDefined) {
  const auto nodes = dataset("2411", node_2411(12, 1, 1, Vector3d::Ones()));
  const auto file = read(nodes);
  EXPECT_EQ(file.set.outputs[0].direction, Vector3d::UnitZ());
  EXPECT_TRUE(file.notes.empty()) << testing::PrintToString(file.notes);
}

TEST(UffSystems, WhatIsNotKnownIsNotTakenForGlobal) {
  const Vector3d x = Vector3d::UnitX();
  const Vector3d z = Vector3d::UnitZ();
  const Vector3d nought = Vector3d::Zero();
  struct Case {
    std::string systems, word;
  };
  Matrix3d sheared = Matrix3d::Identity();
  sheared(0, 1) = 0.2;
  const Case cases[] = {
      {"", "system 7 is not in the file"},
      {dataset("18", system_18(3, 0, 0, nought, x, z)), "system 7 is not in the file"},
      {dataset("18", system_18(7, 2, 0, nought, x, z)), "spherical"},
      {dataset("18", system_18(7, 0, 0, nought, x, 2.0 * x)), "one line"},
      {dataset("18", system_18(7, 0, 9, nought, x, z)), "system 9 is not in the file"},
      {dataset("18", system_18(7, 0, 8, nought, x, z) + system_18(8, 0, 7, nought, x, z)),
       "by way of itself"},
      {dataset("18", system_18(7, 0, 0, nought, x, z) + system_18(7, 0, 0, nought, z, x)),
       "defined twice"},
      {dataset("2420", system_2420(7, 0, sheared, nought)), "no rotation"},
      {dataset("2420", system_2420(7, 0, -Matrix3d::Identity(), nought)), "no rotation"},
      {dataset("18", "         7         0         0         8         1\nCS\n  1.0  oops\n"),
       "system 7 is not in the file"},
      {dataset("18", system_18(7, 1, 0, nought, x, z)), "lies on its axis"},
  };
  const auto nodes = dataset("15", node_15(12, 0, 7, Vector3d(0.0, 0.0, 2.0)));
  for (const auto& one : cases) {
    SCOPED_TRACE(one.word);
    const auto file = read(one.systems + nodes);
    EXPECT_EQ(file.set.outputs[0].direction, nought);
    EXPECT_EQ(times(file.notes, one.word), 1) << testing::PrintToString(file.notes);
    EXPECT_EQ(times(file.notes, "the direction is not known"), 1);
  }
}

TEST(UffSystems, ADatasetThatIsCutOffDefinesSystemsAllTheSame) {
  const auto file = read(dataset("2420", "         1\nPart1\n") +
                         dataset("2420", "         1\nPart1\n         1         0\n") +
                         dataset("2411", node_2411(12, 0, 1, Vector3d::Ones())));
  EXPECT_EQ(file.set.outputs[0].direction, Vector3d::Zero());
  EXPECT_EQ(times(file.notes, "not read"), 1);
}

TEST(UffSystems, RecordingsOfOneNameAreTheirDegreesOfFreedom) {
  Sample58 z;
  z.function_type = 1;
  z.ordinate_type = 4;
  z.response_name = "triax";
  Sample58 x = z;
  x.response_direction = 1;
  const auto two = parse_time_uff(dataset_58(z) + dataset_58(x), "t.uff", {}).data;
  ASSERT_EQ(two.outputs.size(), 2U);
  EXPECT_EQ(two.outputs[0].name, "12z");
  EXPECT_EQ(two.outputs[1].name, "12x");
  EXPECT_EQ(two.records.size(), 1U);  // not two recordings of one channel
  const auto one = parse_time_uff(dataset_58(z) + dataset_58(z), "t.uff", {}).data;
  EXPECT_EQ(one.outputs[0].name, "triax");
  EXPECT_EQ(one.records.size(), 2U);
}

TEST(UffSystems, ANameOfASensorAndAnActuatorHasTheSideOfTheFile) {
  Sample58 motion;
  motion.function_type = 1;
  motion.ordinate_type = 4;
  motion.response_name = "pair";
  Sample58 force = motion;
  force.ordinate = 13;
  force.unit = "N";
  TimeOptions options;
  options.sensor_names = {"pair", "other"};
  options.actuator_names = {"pair"};
  const auto bytes = dataset_58(motion) + dataset_58(force);
  const auto found = parse_time_uff(bytes, "t.uff", options).data;
  ASSERT_EQ(found.outputs.size(), 1U);
  ASSERT_EQ(found.inputs.size(), 1U);
  EXPECT_EQ(found.outputs[0].name, "pair");
  EXPECT_EQ(found.inputs[0].name, "pair");
  EXPECT_EQ(found.records.size(), 1U);
  // What the file says itself counts more than the type.
  const auto back = parse_time_uff(written_uff(found, UffEncoding::binary), "t.uff", options).data;
  EXPECT_EQ(back.outputs.size(), 1U);
  EXPECT_EQ(back.inputs.size(), 1U);
  options.actuator_names.clear();
  EXPECT_EQ(parse_time_uff(bytes, "t.uff", options).data.inputs.size(), 0U);
}

TEST(UffSystems, RecordingsAreTurnedToo) {
  const Matrix3d axes = turn();
  Sample58 z;
  z.function_type = 1;
  z.ordinate_type = 4;
  Sample58 x = z;
  x.response_direction = 1;
  Sample58 force = z;
  force.ordinate = 13;
  force.unit = "N";
  force.response_node = 3;
  const auto file =
      parse_time_uff(dataset_164(1.0, 1.0) +
                         dataset("2420", system_2420(2, 0, axes.transpose(), Vector3d::Zero())) +
                         dataset("2411", node_2411(12, 0, 2, Vector3d::Ones())) + dataset_58(z) +
                         dataset_58(x) + dataset_58(force),
                     "t.uff", {});
  ASSERT_EQ(file.data.outputs.size(), 2U);
  EXPECT_LT((file.data.outputs[0].direction - axes.col(2)).norm(), 1e-12);
  EXPECT_LT((file.data.outputs[1].direction - axes.col(0)).norm(), 1e-12);
}

// One response is one body, in whatever unit the file has its frequencies.
TEST(UffAbscissa, FrequenciesBecomeHertz) {
  struct Case {
    const char* unit;
    double hertz;
    int notes;
  };
  const Case cases[] = {{"Hz", 1.0, 0},
                        {"HZ", 1.0, 0},
                        {"NONE", 1.0, 0},
                        {"kHz", 1e3, 0},
                        {"KHZ", 1e3, 0},
                        {"RPM", 1.0 / 60.0, 0},
                        {"(rad/s)", 0.5 / std::numbers::pi, 0},
                        {"RAD/SEC", 0.5 / std::numbers::pi, 0},
                        {"orders", 1.0, 1}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.unit);
    Sample58 sample;
    sample.abscissa_unit = c.unit;
    const auto file = parse_frf_uff(dataset_58(sample), "t.uff");
    EXPECT_NEAR(file.set.frequency_hz(4), 3.0 * c.hertz, 1e-12 * c.hertz);
    EXPECT_EQ(times(file.notes, "of the abscissa is not known"), c.notes);
    EXPECT_EQ(std::ssize(file.notes), c.notes) << testing::PrintToString(file.notes);
  }
}

// Two quantities of one degree of freedom were two realisations of the first one.
TEST(TimeUff, ADegreeOfFreedomIsOfOneQuantity) {
  Sample58 acceleration;
  acceleration.function_type = 1;
  acceleration.ordinate_type = 4;
  Sample58 again = acceleration;
  again.unit = "g";  // an acceleration, too
  EXPECT_EQ(
      parse_time_uff(dataset_58(acceleration) + dataset_58(again), "t.uff").data.records.size(),
      2U);
  Sample58 displacement = acceleration;
  displacement.ordinate = 8;
  displacement.unit = "mm";
  EXPECT_THROW((void)parse_time_uff(dataset_58(acceleration) + dataset_58(displacement), "t.uff"),
               InvalidInput);
}

// A time in milliseconds was read as seconds.
TEST(UffAbscissa, TimesBecomeSeconds) {
  const auto with = [](const std::string& unit) {
    Sample58 sample;
    sample.function_type = 1;
    sample.ordinate_type = 4;
    sample.abscissa_unit = unit;
    return parse_time_uff(dataset_58(sample), "t.uff");
  };
  EXPECT_EQ(with("s").data.sample_time_s, 0.5);
  EXPECT_NEAR(with("ms").data.sample_time_s, 0.5e-3, 1e-15);
  EXPECT_NEAR(with("SEC").data.sample_time_s, 0.5, 1e-12);
  EXPECT_EQ(times(with("SEC").notes, "of the abscissa"), 0);
  EXPECT_EQ(with("samples").data.sample_time_s, 0.5);
  EXPECT_EQ(times(with("samples").notes, "of the abscissa is not known"), 1);
}

// A rotation has no unit of length, but its system had a fault where the unit was another one.
TEST(UffSystems, InAnotherUnitOfLengthAreScaled) {
  const Matrix3d axes = turn();
  const Vector3d origin(100.0, 200.0, -300.0);  // [mm]
  const auto of_18 = dataset("18", system_18(5, 0, 0, origin, origin + 20.0 * axes.col(0),
                                             origin + 5.0 * axes.col(0) + 30.0 * axes.col(2)));
  const auto of_2420 = dataset("2420", system_2420(5, 0, axes.transpose(), origin));
  const auto node = dataset("15", node_15(12, 5, 5, Vector3d(1.0, 2.0, 3.0)));
  for (const auto& system : {of_18, of_2420}) {
    const auto file = read(dataset_164(1000.0, 1.0) + system + dataset_164(1.0, 1.0) + node);
    EXPECT_LT((file.set.outputs[0].direction - axes.col(2)).norm(), 2e-5);
    const Vector3d place = 1e-3 * origin + axes * Vector3d(1.0, 2.0, 3.0);
    EXPECT_LT((*file.set.outputs[0].position - place).norm(), 1e-4);
    const auto again = read(dataset("2420", system_2420(5, 0, axes.transpose(), 1e-3 * origin)) +
                            dataset_164(1000.0, 1.0) + of_2420 + node);
    EXPECT_EQ(times(again.notes, "defined twice"), 0) << testing::PrintToString(again.notes);
  }
}

// What comes before the fault of a dataset kept the lengths of another unit.
TEST(UffSystems, InAnotherUnitBeforeAFaultAreScaled) {
  const auto broken =
      dataset("18", system_18(5, 0, 0, Vector3d(100.0, 0.0, 0.0), Vector3d(101.0, 0.0, 0.0),
                              Vector3d(100.0, 0.0, 1.0)) +
                        "no system\n");
  const auto file = read(dataset_164(1000.0, 1.0) + broken + dataset_164(1.0, 1.0) +
                         dataset("15", node_15(12, 5, 5, Vector3d::Zero())));
  EXPECT_LT((*file.set.outputs[0].position - Vector3d(0.1, 0.0, 0.0)).norm(), 1e-9);
}

// There was a note for each of them.
TEST(UffSystems, NodesThatAreLeftOutHaveOneNote) {
  std::string nodes;
  for (int node = 12; node < 112; ++node) nodes += node_15(node, 5, 0, Vector3d::Ones());
  const auto file = read(dataset_164(1000.0, 1.0) + dataset("15", nodes));
  EXPECT_EQ(times(file.notes, "and 94 more are placed in a coordinate system"), 1)
      << testing::PrintToString(file.notes);
}

}  // namespace
}  // namespace chladni::io
