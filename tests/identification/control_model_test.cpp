#include "identification/control_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "identification/observed_plant.h"

namespace chladni::identification {
namespace {

// Two rigid-body modes and three others at four sensors and three actuators, with a delay of each
// sensor; the match turns the rigid-body modes and scales the others.
struct Fitted {
  ModalFit fit;
  GainMatch match;
  std::vector<modal::MeasuredChannel> outputs, inputs;
  Eigen::Matrix2d turn;
};

Fitted fitted() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto drawn = [&](Eigen::Index n, Eigen::Index m) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, m, [&] { return normal(random); }));
  };
  Fitted result;
  auto& model = result.fit.model;
  model.frequency_hz.resize(5);
  model.frequency_hz << 0.0, 0.0, 40.0, 130.0, 131.0;
  model.damping_ratio.resize(5);
  model.damping_ratio << 0.0, 0.0, 0.01, 0.002, 0.004;
  model.rigid_count = 2;
  model.output_shapes = drawn(4, 5);
  model.input_shapes = drawn(5, 3);
  model.residual = 1e-7 * drawn(4, 3);
  result.fit.delay_s = 3e-4;
  result.fit.delay_of = DelayOf::outputs;
  result.fit.channel_delay_s = 1e-5 * drawn(4, 1);
  result.turn << 1.2, 0.4, -0.3, 0.8;
  result.match.shapes = model.output_shapes;
  result.match.input_shapes = model.input_shapes;
  result.match.input_shapes.topRows(2) = result.turn * model.input_shapes.topRows(2);
  result.match.input_shapes.row(3) *= -2.5;
  const auto named = [](const std::string& name) {
    modal::MeasuredChannel channel;
    channel.name = name;
    return channel;
  };
  for (int i = 0; i < 4; ++i) result.outputs.push_back(named("s" + std::to_string(i)));
  for (int j = 0; j < 3; ++j) result.inputs.push_back(named("a" + std::to_string(j)));
  return result;
}

void expect_same_responses(const Fitted& one) {
  const auto model = control_model(one.fit, one.match, one.outputs, one.inputs);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(50, 2.0, 300.0);
  const auto expected = responses(one.fit, lines);
  for (Eigen::Index k = 0; k < lines.size(); ++k) {
    const Eigen::MatrixXcd there = expected.row(k).reshaped(4, 3);
    EXPECT_LT((response(model, lines(k)) - there).norm(), 1e-9 * there.norm()) << lines(k);
  }
}

TEST(IdentifiedControlModel, RespondsAsTheFitDoes) {
  auto one = fitted();
  expect_same_responses(one);
  one.fit.delay_of = DelayOf::inputs;
  one.fit.channel_delay_s = Eigen::Vector3d(0.0, 1e-5, 4e-5);
  expect_same_responses(one);
  one.fit.delay_of = DelayOf::all;
  one.fit.channel_delay_s.resize(0);
  expect_same_responses(one);
}

TEST(IdentifiedControlModel, HasTheCoordinatesOfTheMatchedShapes) {
  const auto one = fitted();
  const auto model = control_model(one.fit, one.match, one.outputs, one.inputs);
  for (Eigen::Index m = 0; m < 5; ++m) {
    EXPECT_LT((model.space.b.row(2 * m + 1) - one.match.input_shapes.row(m)).norm(), 1e-12);
  }
}

// A file without units may have any: the model states none either.
TEST(IdentifiedControlModel, StatesNoUnitThatTheFileDoesNot) {
  auto one = fitted();
  one.outputs[1].unit = "m";
  const auto model = control_model(one.fit, one.match, one.outputs, one.inputs);
  EXPECT_EQ(model.outputs[0].unit, "");
  EXPECT_EQ(model.outputs[1].unit, "m");
}

TEST(IdentifiedControlModel, CannotLookAhead) {
  auto one = fitted();
  one.fit.channel_delay_s(2) = -4e-4;
  const auto model = control_model(one.fit, one.match, one.outputs, one.inputs);
  EXPECT_EQ(model.output_delay(2), 0.0);
  const auto notes = left_out_of_control_model(one.fit, one.outputs);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("-100 us"), std::string::npos) << notes[0];
}

// A delay that noise made negative is one of 0.
TEST(IdentifiedControlModel, TakesADelayWithinTwoDeviationsOfZeroForNone) {
  auto one = fitted();
  auto& fit = one.fit;
  const auto is_told = [&] { return !left_out_of_control_model(fit, one.outputs).empty(); };
  fit.channel_delay_s = Eigen::Vector4d(1e-4, -3.9e-4, 0.0, -5e-4);
  fit.delay_s = 3e-4;
  EXPECT_TRUE(is_told());  // of unknown deviation
  fit.channel_delay_std_s = Eigen::Vector4d(1e-6, 5e-5, 1e-6, 1.1e-4);
  EXPECT_FALSE(is_told());
  EXPECT_EQ(control_model(fit, one.match, one.outputs, one.inputs).output_delay(3), 0.0);
  fit.channel_delay_std_s(1) = 4e-5;
  const auto notes = left_out_of_control_model(fit, one.outputs);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("-90 us"), std::string::npos) << notes[0];  // y4's -200 us are noise
  // A channel that was not measured has no delay.
  fit.channel_delay_std_s(1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_told());
  // One delay for all.
  fit.channel_delay_s.resize(0);
  fit.channel_delay_std_s.resize(0);
  fit.delay_s = -2e-6;
  EXPECT_TRUE(is_told());
  fit.delay_std_s = 1.1e-6;
  EXPECT_FALSE(is_told());
  fit.delay_std_s = 0.9e-6;
  EXPECT_TRUE(is_told());
}

TEST(IdentifiedControlModel, SaysWhatAccelerometersLack) {
  auto one = fitted();
  EXPECT_TRUE(left_out_of_control_model(one.fit, one.outputs).empty());
  one.outputs[1].kind = modal::FrfKind::accelerance;
  EXPECT_NE(left_out_of_control_model(one.fit, one.outputs).at(0).find("acceleration"),
            std::string::npos);
  EXPECT_EQ(control_model(one.fit, one.match, one.outputs, one.inputs).outputs[1].unit, "m/s^2");
}

// Complex shapes whose sum is not 0 give an acceleration a part that grows with the frequency; it
// is all that the state space lacks beside the residual. Shapes that are real but for a phase have
// none.
TEST(IdentifiedControlModel, SaysWhatAccelerometersLackOfComplexShapes) {
  auto one = fitted();
  one.fit.model.residual.setZero();
  const std::complex<double> j(0.0, 1.0);
  const auto with_phases = [&](double phase) {
    ComplexShapes shapes;
    shapes.outputs = one.fit.model.output_shapes.cast<std::complex<double>>();
    shapes.inputs = one.fit.model.input_shapes.cast<std::complex<double>>();
    for (Eigen::Index m = 2; m < 5; ++m) {
      shapes.outputs.col(m) *= std::exp(j * phase * static_cast<double>(m));
    }
    one.fit.complex = shapes;
    return left_out_of_control_model(one.fit, one.outputs);
  };
  EXPECT_TRUE(with_phases(0.1).empty());
  for (auto& output : one.outputs) output.kind = modal::FrfKind::accelerance;
  EXPECT_TRUE(with_phases(0.0).empty());
  const auto notes = with_phases(0.1);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("complex shapes"), std::string::npos);
  const auto space = state_space(one.fit.model, *one.fit.complex);
  const auto model = control_model(one.fit, one.match, one.outputs, one.inputs);
  for (const double hz : {20.0, 300.0}) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * hz);
    const Eigen::MatrixXcd displacement = response(space, hz);
    modal::ControlModel early = model;
    early.output_delay.setZero();
    const Eigen::MatrixXcd lacks = s * s * displacement - response(early, hz);
    EXPECT_LT((lacks - s * (space.c * space.b)).norm(), 1e-8 * lacks.norm());
  }
}

// Heave of 2 and tilt of 3 x: a floor that moves up moves all by one, Γ = (1/2, 0). What a sensor
// that was not measured has as its shape says nothing.
TEST(FloorParticipation, LeavesOutChannelsThatWereNotMeasured) {
  GainMatch match;
  match.shapes = Eigen::MatrixXd{{2.0, -0.6, 0.3}, {2.0, 0.0, 0.2}, {2.0, 0.9, -0.7}};
  match.deviation = Eigen::MatrixXd::Constant(3, 3, 1e-3);
  const std::vector<Eigen::Index> rigid{0, 1};
  const Eigen::Vector3d along = Eigen::Vector3d::Ones();
  const Eigen::Vector3d expected(0.5, 0.0, 0.0);
  EXPECT_LT((floor_participation(match, rigid, along) - expected).norm(), 1e-12);
  match.shapes.row(1).setZero();
  match.deviation.row(1).setConstant(std::numeric_limits<double>::infinity());
  EXPECT_LT((floor_participation(match, rigid, along) - expected).norm(), 1e-12);
  // One row is left for two motions.
  match.deviation.row(2).setConstant(std::numeric_limits<double>::infinity());
  EXPECT_EQ(floor_participation(match, rigid, along).size(), 0);
}

}  // namespace
}  // namespace chladni::identification
