#include "steps/control_models.h"

#include <gtest/gtest.h>

#include <cmath>

#include "steps/rigid_body.h"
#include "tests/modal/chain.h"
#include "tests/refusal.h"
#include "tests/study/plate_text.h"

namespace chladni::steps {
namespace {

study::Study with(const std::string& tables) {
  return study::parse_study(study::kPlateText + tables, "plate.toml");
}

modal::ControlModel chain_model(double damping_ratio) {
  auto model = modal::control_model(
      modal::reduced(modal::chain(20, true), 6, {0, 7}, {2, 19}, damping_ratio), {{"s1"}, {"s2"}},
      {"a1", "a2"});
  model.input_delay << 2.5e-4, 0.0;
  return model;
}

TEST(ControlModels, WithoutTheTableAreContinuousAndWhole) {
  const auto models = control_models(with(""), chain_model(0.01));
  EXPECT_FALSE(models.discrete);
  EXPECT_EQ(models.continuous.space.a.rows(), 12);
  EXPECT_EQ(models.hankel.size(), 12);
  EXPECT_EQ(models.continuous.input_delay(0), 2.5e-4);
  EXPECT_EQ(control_models(with(""), chain_model(0.0)).hankel.size(), 0);
}

TEST(ControlModels, FollowTheTable) {
  const auto models =
      control_models(with("[state_space]\nsample_rate = \"10 kHz\"\nstates = 6\npade_order = 3\n"),
                     chain_model(0.01));
  EXPECT_EQ(models.continuous.space.a.rows(), 6 + 3);
  EXPECT_EQ(models.kept_states, 6);
  EXPECT_GT(models.error_bound, 0.0);
  EXPECT_TRUE(models.position.empty());
  ASSERT_TRUE(models.discrete);
  EXPECT_EQ(models.discrete->space.sample_time_s, 1e-4);
  EXPECT_EQ(models.discrete->space.a.rows(), 7);  // half a sample of delay
  EXPECT_EQ(models.discrete->input_delay(0), 2.0);
  ASSERT_EQ(models.notes.size(), 1U);
  EXPECT_NE(models.notes[0].find("Pade"), std::string::npos);
}

TEST(ControlModels, SayWhatIsWrongWithTheStudy) {
  const auto refused = [](const std::string& keys, double damping_ratio) {
    return refusal_of(
        [&] { return control_models(with("[state_space]\n" + keys), chain_model(damping_ratio)); });
  };
  EXPECT_EQ(refused("states = 40\n", 0.01).find("plate.toml: [state_space]: "), 0U);
  EXPECT_NE(refused("states = 6\n", 0.0).find("undamped"), std::string::npos);
  EXPECT_NE(refused("sample_rate = \"100 MHz\"\n", 0.01).find("25000 samples"), std::string::npos);
}

TEST(ControlModels, SayThatAModeIsAnAlias) {
  const auto models =
      control_models(with("[state_space]\nsample_rate = \"300 Hz\"\n"), chain_model(0.01));
  ASSERT_FALSE(models.notes.empty());
  EXPECT_NE(models.notes[0].find("alias"), std::string::npos);
}

// A dashpot has a real pole: no mode, however fast.
TEST(ControlModels, CallNoDashpotAMode) {
  auto model = chain_model(0.01);
  auto& space = model.space;
  const auto n = space.a.rows();
  space.a.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, n + 1));
  space.b.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, 2));
  space.c.conservativeResizeLike(Eigen::MatrixXd::Zero(2, n + 1));
  space.a(n, n) = -2e5;
  space.b(n, 0) = space.c(0, n) = 1e-3;
  model.states.push_back({"dashpot_1", "W^1/2"});
  const auto notes = [&](const std::string& rate) {
    return control_models(with("[state_space]\nsample_rate = \"" + rate + "\"\n"), model).notes;
  };
  EXPECT_TRUE(notes("10 kHz").empty());
  const auto alias = notes("300 Hz");
  ASSERT_FALSE(alias.empty());
  const auto modes =
      control_models(with("[state_space]\nsample_rate = \"300 Hz\"\n"), chain_model(0.01)).notes;
  EXPECT_EQ(alias, modes);
}

modal::MeasuredChannel along_z(const std::string& name, double x, double y) {
  modal::MeasuredChannel channel;
  channel.name = name;
  channel.position = Eigen::Vector3d(x, y, 0.0);
  channel.direction = Eigen::Vector3d::UnitZ();
  channel.unit = "m";
  return channel;
}

// A plate of 4 kg with its centre at (10, -20) mm at four sensors and three actuators along z.
IdentifiedModel plate(Eigen::Index rigid_count) {
  IdentifiedModel model;
  model.seen.outputs = {along_z("s1", -0.2, -0.15), along_z("s2", 0.2, -0.15),
                        along_z("s3", 0.2, 0.15), along_z("s4", -0.2, 0.15)};
  model.seen.inputs = {along_z("a1", -0.1, 0.0), along_z("a2", 0.1, 0.05),
                       along_z("a3", 0.0, -0.1)};
  const auto shapes = [](const std::vector<modal::MeasuredChannel>& channels) {
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(channels.size()), 3);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const auto& at = *channels[static_cast<std::size_t>(i)].position;
      rows.row(i) << 1.0 / std::sqrt(4.0), (at.y() + 0.02) / std::sqrt(0.03),
          (at.x() - 0.01) / std::sqrt(0.05);
    }
    return rows;
  };
  auto& fit = model.found.fit;
  fit.model.rigid_count = rigid_count;
  fit.model.frequency_hz = Eigen::VectorXd::Zero(3);
  fit.model.frequency_hz.tail(3 - rigid_count).setConstant(200.0);
  fit.model.damping_ratio = Eigen::VectorXd::Zero(3);
  fit.model.output_shapes = model.match.shapes = shapes(model.seen.outputs);
  fit.model.input_shapes = model.match.input_shapes = shapes(model.seen.inputs).transpose();
  model.data.frequency_hz = Eigen::Vector2d(20.0, 400.0);
  return model;
}

TEST(RigidBodyOfChannels, IsThePlateThatMoves) {
  const auto found = rigid_body_of_channels(with(""), plate(3));
  ASSERT_TRUE(found && found->properties);
  EXPECT_TRUE(found->notes.empty());
  EXPECT_FALSE(found->up_to_a_factor);
  EXPECT_NEAR(found->properties->mass, 4.0, 1e-8);
  EXPECT_NEAR(found->properties->centre(0), 0.01, 1e-9);
  EXPECT_NEAR(found->properties->centre(1), -0.02, 1e-9);
  EXPECT_NEAR(found->properties->inertia(0, 0), 0.03, 1e-9);
  EXPECT_NEAR(found->properties->inertia(1, 1), 0.05, 1e-9);
  EXPECT_EQ(found->properties->not_told.size(), 2U);  // height of the centre, spin about z
  // Unit acceleration of the centre along z: the sensors' mean is no tilt.
  const Eigen::VectorXd tilt = found->sensors.matrix * Eigen::VectorXd::Ones(4);
  EXPECT_LT((tilt - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-9);
}

TEST(RigidBodyOfChannels, MissingMotionIsToldUnlessTheBodyIsHeld) {
  const auto free = rigid_body_of_channels(with(""), plate(0));
  ASSERT_TRUE(free);
  EXPECT_FALSE(free->properties);
  ASSERT_EQ(free->notes.size(), 1U);
  EXPECT_NE(free->notes[0].find("below 20 Hz"), std::string::npos) << free->notes[0];
  const auto held = rigid_body_of_channels(with(R"([[attachment]]
kind = "spring"
name = "leg"
at = ["0 mm", "0 mm"]
direction = "z"
stiffness = "1 kN/m"
)"),
                                           plate(0));
  ASSERT_TRUE(held);
  EXPECT_TRUE(held->notes.empty());
}

// Matrices by geometry are those of the stated directions, whatever the responses say of these.
TEST(RigidBodyOfChannels, SaysThatActuatorsCountAgainstTheirDirections) {
  auto model = plate(3);
  model.match.side = -1;
  const auto found = rigid_body_of_channels(with(""), model);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->notes.size(), 1U);
  EXPECT_NE(found->notes[0].find("needs the other sign"), std::string::npos);
}

TEST(RigidBodyOfChannels, NamesTheChannelsOfItsMatrices) {
  auto model = plate(3);
  const auto alike = rigid_body_of_channels(with(""), model);
  ASSERT_TRUE(alike);
  EXPECT_EQ(alike->sensor_names, (std::vector<std::string>{"s1", "s2", "s3", "s4"}));
  EXPECT_EQ(alike->actuator_names, (std::vector<std::string>{"a1", "a2", "a3"}));
  model.seen.outputs[2].kind = modal::FrfKind::accelerance;
  const auto mixed = rigid_body_of_channels(with(""), model);
  ASSERT_TRUE(mixed);
  ASSERT_EQ(mixed->notes.size(), 1U);
  EXPECT_NE(mixed->notes[0].find("different quantities"), std::string::npos);
}

TEST(RigidBodyOfChannels, NeedsPlaces) {
  auto model = plate(3);
  model.seen.inputs[1].position.reset();
  EXPECT_FALSE(rigid_body_of_channels(with(""), model));
}

}  // namespace
}  // namespace chladni::steps
