// Which nodes the channels of an identified model become in a universal file, and how they move;
// what a table of its shapes says of values that are not known.
#include "show/modes_uff.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "io/node_shapes.h"
#include "io/shape_table.h"
#include "show/identification.h"

namespace chladni::show {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

struct Seen {
  std::string name;
  Vector3d place, direction;
  std::optional<long long> node;
};

// A model of two modes whose rows are these sensors, and one actuator more.
steps::IdentifiedModel model_of(const std::vector<Seen>& sensors, const Seen& actuator,
                                const Eigen::MatrixXd& shapes) {
  steps::IdentifiedModel model;
  const auto add = [](const Seen& one, std::vector<modal::MeasuredChannel>& side) {
    auto& channel = side.emplace_back();
    channel.name = one.name;
    channel.node = one.node;
    channel.direction = one.direction;
    channel.position = one.place;
  };
  for (const auto& sensor : sensors) {
    model.match.rows.push_back({false, std::ssize(model.seen.outputs)});
    add(sensor, model.seen.outputs);
  }
  add(actuator, model.seen.inputs);
  model.match.rows.push_back({true, 0});
  model.match.shapes = shapes;
  model.match.modes.resize(2);
  model.match.modes[1].by = identification::MatchedBy::pairs;
  model.found.fit.model.frequency_hz = Eigen::Vector2d(10.0, 20.0);
  model.found.fit.model.damping_ratio = Eigen::Vector2d(0.01, 0.02);
  return model;
}

Vector3d motion(const io::UffModes& modes, long long node, Index mode) {
  const auto at = std::ranges::find(modes.node, node);
  EXPECT_NE(at, modes.node.end()) << node;
  return modes.shapes.col(mode).segment<3>(3 * (at - modes.node.begin()));
}

TEST(ChannelModesUff, ChannelsAtOnePlaceAreOneNode) {
  const Vector3d corner(0.1, 0.2, 0.0), middle(0.0, 0.0, 0.0), far(0.5, 0.0, 0.0);
  const Vector3d oblique = Vector3d(1.0, 0.0, 1.0).normalized();
  const std::vector<Seen> sensors{
      {"cx", corner, Vector3d::UnitX(), {}},  {"cy", corner, Vector3d::UnitY(), 7},
      {"cz", corner, -Vector3d::UnitZ(), {}}, {"m1", middle, oblique, {}},
      {"f1", far, Vector3d::UnitZ(), 1},      {"f2", far, Vector3d::UnitZ(), 1}};
  Eigen::MatrixXd shapes(7, 2);
  shapes << 1, -1, 2, -2, 3, -3, 4, 0.5, 6, 1, 8, 3, 9, -5;
  const auto model = model_of(sensors, {"a1", middle, Vector3d::UnitY(), {}}, shapes);
  study::Study study;
  study.title = "three nodes";
  study::Channel stated;
  stated.name = "m1";
  stated.node = 30;  // the study's number counts, whatever the file says
  study.sensors = {stated};
  const auto modes = channel_modes_uff(study, model);
  EXPECT_EQ(modes.node, (std::vector<long long>{7, 30, 1}));
  EXPECT_EQ(modes.place.row(0), corner.transpose());
  EXPECT_EQ(modes.lines.size(), 2U);
  EXPECT_EQ(modes.has_scale, (std::vector<bool>{false, true}));
  EXPECT_TRUE(motion(modes, 7, 0).isApprox(Vector3d(1.0, 2.0, -3.0), 1e-12));
  // The shortest motion with 4 along the oblique direction and 9 along y.
  EXPECT_TRUE(motion(modes, 30, 0).isApprox(4.0 * oblique + Vector3d(0.0, 9.0, 0.0), 1e-12));
  // Two sensors that see the same: their mean.
  EXPECT_TRUE(motion(modes, 1, 0).isApprox(Vector3d(0.0, 0.0, 7.0), 1e-12));
  EXPECT_TRUE(motion(modes, 1, 1).isApprox(Vector3d(0.0, 0.0, 2.0), 1e-12));
}

TEST(ChannelModesUff, ChannelsWithoutANodeGetTheLowestFreeNumbers) {
  const auto at = [](double x) { return Vector3d(x, 0.0, 0.0); };
  const Vector3d z = Vector3d::UnitZ();
  const auto model = model_of({{"s1", at(1), z, {}}, {"s2", at(2), z, 2}, {"s3", at(3), z, {}}},
                              {"a1", at(4), z, 1}, Eigen::MatrixXd::Identity(4, 2));
  EXPECT_EQ(channel_modes_uff({}, model).node, (std::vector<long long>{3, 2, 4, 1}));
}

TEST(ChannelModesUff, AChannelThatWasNotMeasuredIsNoNode) {
  const auto at = [](double x) { return Vector3d(x, 0.0, 0.0); };
  const Vector3d z = Vector3d::UnitZ();
  Eigen::MatrixXd shapes = Eigen::MatrixXd::Ones(3, 2);
  shapes(1, 0) = NAN;
  const auto model =
      model_of({{"s1", at(1), z, {}}, {"s2", at(2), z, {}}}, {"a1", at(3), z, {}}, shapes);
  const auto modes = channel_modes_uff({}, model);
  EXPECT_EQ(modes.node, (std::vector<long long>{1, 2}));
  EXPECT_EQ(modes.place(1, 0), 3.0);
  EXPECT_NE(io::modes_uff(modes, io::ShapeDataset::nodes_55), "");
}

// A channel without measurements has the value 0 of an infinite deviation.
TEST(ChannelModesUff, AChannelThatNoModeKnowsIsNoNode) {
  const auto at = [](double x) { return Vector3d(x, 0.0, 0.0); };
  const Vector3d z = Vector3d::UnitZ();
  Eigen::MatrixXd shapes = Eigen::MatrixXd::Ones(3, 2);
  shapes.row(1).setZero();
  auto model = model_of({{"s1", at(1), z, {}}, {"s2", at(2), z, {}}}, {"a1", at(3), z, {}}, shapes);
  model.match.deviation = Eigen::MatrixXd::Constant(3, 2, 0.1);
  model.match.deviation.row(1).setConstant(std::numeric_limits<double>::infinity());
  const auto modes = channel_modes_uff({}, model);
  EXPECT_EQ(modes.node, (std::vector<long long>{1, 2}));
  EXPECT_EQ(modes.place(1, 0), 3.0);
}

// Three places, one of which has two sensors, and an actuator.
steps::IdentifiedModel five_rows() {
  const auto at = [](double x) { return Vector3d(x, 0.0, 0.0); };
  const Vector3d y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  Eigen::MatrixXd shapes(5, 2);
  shapes << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0;
  auto model =
      model_of({{"s1", at(1), z, 1}, {"s2", at(2), z, 2}, {"s3", at(3), z, 3}, {"s4", at(3), y, 3}},
               {"a1", at(4), z, 4}, shapes);
  model.match.modes[0].by = identification::MatchedBy::pairs;
  model.match.deviation = Eigen::MatrixXd::Constant(5, 2, 0.1);
  return model;
}

constexpr double kNotKnown = std::numeric_limits<double>::infinity();

std::vector<io::NodeShape> read_back(const steps::IdentifiedModel& model) {
  const auto text = io::modes_uff(channel_modes_uff({}, model), io::ShapeDataset::nodes_55);
  return io::parse_node_shapes(text, "test").modes;
}

// A node that a mode does not know is not in the mode's record: a reader would take its number, or
// a 0, for measured.
TEST(ChannelModesUff, AModeHasNoRecordOfANodeThatItDoesNotKnow) {
  auto model = five_rows();
  model.match.deviation(1, 0) = kNotKnown;
  model.match.deviation(3, 1) = kNotKnown;  // node 3 knows z alone, its y would be 0
  const auto modes = read_back(model);
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_EQ(modes[0].motion.size(), 3U);
  EXPECT_FALSE(modes[0].motion.contains(2));
  EXPECT_NEAR(modes[0].motion.at(3).z().real(), 5.0, 1e-5);
  EXPECT_NEAR(modes[0].motion.at(3).y().real(), 7.0, 1e-5);
  EXPECT_EQ(modes[1].motion.size(), 3U);
  EXPECT_NEAR(modes[1].motion.at(2).z().real(), 4.0, 1e-5);
  EXPECT_FALSE(modes[1].motion.contains(3));
}

// Without a scale the fit knows its sensors alone: the actuator has a guess. A mode that no node
// knows has no record.
TEST(ChannelModesUff, AModeWithoutAScaleIsKnownAtItsSensors) {
  auto model = five_rows();
  model.match.modes[0].by = identification::MatchedBy::nothing;
  model.match.deviation.col(0).setConstant(kNotKnown);
  model.found.fit.output_std = Eigen::MatrixXd::Constant(4, 2, 0.1);
  model.found.fit.output_std(0, 0) = kNotKnown;
  auto modes = read_back(model);
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_FALSE(modes[0].motion.contains(1));
  EXPECT_NEAR(modes[0].motion.at(2).z().real(), 3.0, 1e-5);
  EXPECT_FALSE(modes[0].motion.contains(4));
  model.found.fit.output_std.col(0).setConstant(kNotKnown);
  modes = read_back(model);
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_EQ(modes[0].frequency_hz, 20.0);
}

// A body's motions at 0 Hz may have a scale whose deviation nothing tells: their shape is known.
TEST(ChannelModesUff, AModeWithAScaleOfUnknownDeviationIsKnownAtItsSensors) {
  auto model = five_rows();
  model.match.modes[0].by = identification::MatchedBy::geometry;
  model.match.deviation.col(0).setConstant(kNotKnown);
  model.found.fit.output_std = Eigen::MatrixXd::Constant(4, 2, 0.1);
  const auto modes = read_back(model);
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_NEAR(modes[0].motion.at(2).z().real(), 3.0, 1e-5);
}

// What is not known is an empty cell, which no reader takes for a measured 0.
TEST(IdentifiedShapes, ComeBackFromTheirTableWithoutWhatIsNotKnown) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  const Vector3d z = Vector3d::UnitZ();
  Eigen::MatrixXd shapes(3, 2);
  shapes << 1.0, 5.0, 0.0, 7.0, 0.0, 0.0;
  auto model = model_of({{"s1", z, z, 1}, {"s2", 2.0 * z, z, 2}}, {"a1", 3.0 * z, z, 3}, shapes);
  model.match.deviation.resize(3, 2);
  model.match.deviation << 0.1, 0.2, kUnknown, 0.3, kUnknown, kUnknown;
  const auto file = std::filesystem::temp_directory_path() /
                    ("chladni_identified_shapes_" + std::to_string(getpid()) + ".csv");
  io::write_shapes(file, identified_shapes(model));
  const auto back = io::read_shapes(file, io::ShapesStated::partly);
  std::filesystem::remove(file);
  EXPECT_EQ(back.channels, (std::vector<std::string>{"s1", "s2", "a1"}));
  EXPECT_EQ(back.values.row(0), shapes.row(0));
  EXPECT_TRUE(std::isnan(back.values(1, 0)));
  EXPECT_EQ(back.values(1, 1), 7.0);
  EXPECT_TRUE(std::isnan(back.values(2, 0)) && std::isnan(back.values(2, 1)));
  EXPECT_EQ(back.deviation, (Eigen::MatrixXd(3, 2) << 0.1, 0.2, 0.0, 0.3, 0.0, 0.0).finished());
}

TEST(ChannelModesUff, AModeBeyondTheLinesThatNothingTellsOfIsLeftOut) {
  const Vector3d z = Vector3d::UnitZ();
  Eigen::MatrixXd shapes(2, 2);
  shapes << 1.0, 5.0, 2.0, 7.0;
  auto model = model_of({{"s1", z, z, 1}}, {"a1", 2.0 * z, z, 2}, shapes);
  model.judgement.beyond_lines = {0};
  const auto modes = channel_modes_uff({}, model);
  ASSERT_EQ(modes.frequency_hz.size(), 1);
  EXPECT_EQ(modes.frequency_hz(0), 20.0);
  EXPECT_EQ(modes.damping_ratio(0), 0.02);
  EXPECT_EQ(modes.has_scale, (std::vector<bool>{true}));
  EXPECT_TRUE(motion(modes, 2, 0).isApprox(7.0 * z, 1e-12));
}

}  // namespace
}  // namespace chladni::show
