// Lengths that decide on pairs and on lines are parts of the body: its size changes nothing.
#include "identification/channel_gains.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "identification/response_field.h"
#include "tests/recordings/rigs.h"

namespace chladni::identification {
namespace {

using PlacedChannels = std::vector<modal::MeasuredChannel>;

PlacedChannels placed(const std::string& letter, const Eigen::MatrixX3d& places,
                      const Eigen::Vector3d& direction = Eigen::Vector3d::UnitZ()) {
  PlacedChannels channels;
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    modal::MeasuredChannel channel;
    channel.name = letter + std::to_string(i + 1);
    channel.position = places.row(i).transpose();
    channel.direction = direction;
    channels.push_back(channel);
  }
  return channels;
}

// A fit of given numbers of sensors and actuators; its values do not matter here.
ModalFit some_fit(Eigen::Index outputs, Eigen::Index inputs, Eigen::Index rigid,
                  Eigen::Index flexible) {
  ModalFit fit;
  auto& model = fit.model;
  const auto modes = rigid + flexible;
  model.rigid_count = rigid;
  model.frequency_hz = Eigen::VectorXd::Zero(modes);
  model.damping_ratio = Eigen::VectorXd::Zero(modes);
  model.frequency_hz.tail(flexible).setConstant(100.0);
  model.damping_ratio.tail(flexible).setConstant(0.01);
  model.output_shapes.setConstant(outputs, modes, 0.8);
  model.input_shapes.setConstant(modes, inputs, 0.8);
  model.output_shapes.row(0) *= 0.5;
  model.input_shapes.col(0) *= -0.5;
  model.residual.setZero(outputs, inputs);
  return fit;
}

// A coil 5 mm beside its sensor on half a metre is beside it on 5 mm, too: 50 um.
TEST(ChannelGains, OfPairsDoNotTurnOnTheSizeOfTheBody) {
  for (const double scale : {1.0, 0.01, 100.0}) {
    modal::FrfSet set;
    set.outputs = placed("y", scale * Eigen::MatrixX3d{{-0.2, 0.1, 0.0}, {0.2, -0.1, 0.0}});
    set.inputs = placed("u", scale * Eigen::MatrixX3d{{-0.195, 0.1, 0.0}, {0.2002, -0.1, 0.01}});
    GainPlan plan;
    plan.pairs_within = 0.01 * scale;
    GainSimulation simulation;
    simulation.size_m = [&] { return 0.6 * scale; };
    simulation.at_channels = [] {
      return SimulatedChannels{Eigen::VectorXd::Constant(1, 100.0),
                               Eigen::MatrixXd::Constant(2, 1, 0.8),
                               Eigen::MatrixXd::Constant(2, 1, 0.7)};
    };
    const auto gains = channel_gains(some_fit(2, 2, 0, 1), set, plan, simulation);
    ASSERT_EQ(gains.pairs.size(), 2U) << scale;
    EXPECT_FALSE(gains.pairs[0].is_one_place()) << scale;
    EXPECT_TRUE(gains.pairs[1].is_one_place()) << scale;
  }
}

// Two of a plate's three motions are none of a beam, though the plate is half a millimetre wide.
TEST(ChannelGains, OfAPlateAreThoseOfAPlateOfAnySize) {
  for (const double scale : {1.0, 1e-3}) {
    const Eigen::MatrixX3d sensors =
        scale *
        Eigen::MatrixX3d{{-0.2, -0.1, 0.0}, {0.2, -0.1, 0.0}, {-0.2, 0.15, 0.0}, {0.2, 0.1, 0.0}};
    const Eigen::MatrixX3d coils = scale * Eigen::MatrixX3d{{-0.1, 0.05, 0.0}, {0.15, -0.05, 0.0}};
    modal::FrfSet set;
    set.outputs = placed("y", sensors);
    set.inputs = placed("u", coils);
    const Eigen::Vector3d size(1.0, 1.0 / scale, 1.0 / scale);
    const Eigen::Matrix3d inverse_mass =
        size.asDiagonal() * Eigen::Matrix3d{{0.5, 0.1, -0.2}, {0.1, 6.0, 0.4}, {-0.2, 0.4, 5.0}} *
        size.asDiagonal();
    auto fit = some_fit(4, 2, 2, 0);
    fit.model.output_shapes = rigid_directions(sensors, RigidMotion::plate) * inverse_mass *
                              rigid_directions(coils, RigidMotion::plate).transpose();
    fit.model.input_shapes.setIdentity();
    GainPlan plan;
    plan.pairs_within = 0.01 * scale;
    const auto match = channel_gains(fit, set, plan, {}).match;
    EXPECT_EQ(match.modes[0].by, MatchedBy::nothing) << scale;
    EXPECT_FALSE(match.rigid.has_value()) << scale;
  }
}

// Forces at one end of a rod and sensors at the other act along one line, and are no pairs for the
// simulation that response_field has.
TEST(ChannelGains, OfARodHaveNoPairsFromEndToEnd) {
  constexpr Eigen::Index kModes = 5;
  constexpr double kPi = std::numbers::pi;
  const auto shapes_at = [&](const Eigen::VectorXd& x) {
    Eigen::MatrixXd shapes(x.size(), kModes);
    for (Eigen::Index k = 0; k < kModes; ++k) {
      shapes.col(k) = (static_cast<double>(k + 1) * kPi * x.array()).sin();
    }
    return shapes;
  };
  const auto places_at = [&](const Eigen::VectorXd& x) {
    priors::Places places{Points::Zero(x.size(), 3), Points::Zero(x.size(), 3), shapes_at(x)};
    places.position.col(0) = x;
    places.direction.col(0).setOnes();
    return places;
  };
  priors::Simulation simulation;
  simulation.frequency_hz = 30.0 * Eigen::VectorXd::LinSpaced(kModes, 1.0, kModes);
  simulation.surface = places_at(Eigen::VectorXd::LinSpaced(81, 0.0, 1.0));
  simulation.area = Eigen::VectorXd::Constant(81, 1.0 / 81.0);
  const auto outputs = places_at(Eigen::Vector4d(0.08, 0.17, 0.29, 0.41));
  const auto inputs = places_at(Eigen::Vector2d(0.77, 0.9));
  modal::FrfSet set;
  set.outputs = placed("y", outputs.position, Eigen::Vector3d::UnitX());
  set.inputs = placed("u", inputs.position, Eigen::Vector3d::UnitX());
  set.frequency_hz = Eigen::VectorXd::LinSpaced(500, 15.0, 105.0);
  set.value = modal::frf(recordings::model_of(simulation.frequency_hz.head(3), 0.01,
                                              outputs.shapes.leftCols(3),
                                              inputs.shapes.leftCols(3).transpose()),
                         set.frequency_hz)
                  .value;
  for (const auto& value : set.value) {
    set.variance.push_back(Eigen::MatrixXd::Constant(value.rows(), value.cols(), 1e-18));
  }
  ResponseFieldPlan plan;
  plan.gains.is_supported = true;
  const auto field = response_field(set, simulation, outputs, inputs, plan);
  EXPECT_TRUE(field.gains().pairs.empty());
  for (const auto& mode : field.gains().match.modes) EXPECT_EQ(mode.by, MatchedBy::prior);
}

}  // namespace
}  // namespace chladni::identification
