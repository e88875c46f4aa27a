// G(ρ) of a pinned beam, whose modes are sines: responses between the sensors from arrays alone.
#include "identification/response_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "base/error.h"
#include "tests/recordings/rigs.h"
#include "tests/refusal.h"

namespace chladni::identification {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLength = 1.5;  // [m]; the beam's mass is 2 kg
constexpr Eigen::Index kModes = 10;

Eigen::MatrixXd sines(const Eigen::VectorXd& x) {
  Eigen::MatrixXd shapes(x.size(), kModes);
  for (Eigen::Index k = 0; k < kModes; ++k) {
    shapes.col(k) = (static_cast<double>(k + 1) * kPi / kLength * x.array()).sin();
  }
  return shapes;  // √(2/m) is 1
}

Eigen::VectorXd frequencies(double first_hz) {
  return Eigen::VectorXd::LinSpaced(kModes, 1.0, kModes).cwiseAbs2() * first_hz;
}

priors::Places places_at(const Eigen::VectorXd& x) {
  priors::Places places{Points::Zero(x.size(), 3), Points::Zero(x.size(), 3), sines(x)};
  places.position.col(0) = x;
  places.direction.col(2).setOnes();
  return places;
}

// The simulation is stiffer than the beam: all its frequencies are 3 % too high.
priors::Simulation simulation() {
  priors::Simulation simulation;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(121, 0.0, kLength);
  simulation.frequency_hz = frequencies(20.6);
  simulation.surface = places_at(x);
  simulation.area = Eigen::VectorXd::Constant(x.size(), kLength / 121.0);
  return simulation;
}

Eigen::VectorXd sensors() {
  Eigen::VectorXd x(9);
  x << 0.11, 0.27, 0.4, 0.58, 0.71, 0.93, 1.07, 1.22, 1.41;
  return x;
}

modal::Frf truth(const Eigen::VectorXd& outputs, const Eigen::VectorXd& inputs,
                 const Eigen::VectorXd& frequency_hz, Eigen::Index modes = 4) {
  return modal::frf(
      recordings::model_of(frequencies(20.0).head(modes), 0.01, sines(outputs).leftCols(modes),
                           sines(inputs).leftCols(modes).transpose()),
      frequency_hz);
}

std::vector<modal::MeasuredChannel> channels_at(const std::string& letter,
                                                const Eigen::VectorXd& x) {
  auto result = recordings::channels(letter, x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    auto& channel = result[static_cast<std::size_t>(i)];
    channel.position = Eigen::Vector3d(x(i), 0.0, 0.0);
    channel.direction = Eigen::Vector3d::UnitZ();
  }
  return result;
}

// Responses up to between the fourth and the fifth mode, with noise of known variance.
modal::FrfSet responses_of(const Eigen::VectorXd& inputs, double output_gain = 1.0,
                           Eigen::Index modes = 4) {
  modal::FrfSet set;
  set.outputs = channels_at("y", sensors());
  set.inputs = channels_at("u", inputs);
  set.frequency_hz = Eigen::VectorXd::LinSpaced(1561, 10.0, 400.0);
  set.value = truth(sensors(), inputs, set.frequency_hz, modes).value;
  const double noise = 1e-7;  // [m/N], a hundredth of the fourth resonance
  std::mt19937 random(7);
  std::normal_distribution<double> part(0.0, noise / std::numbers::sqrt2);
  for (auto& value : set.value) {
    for (auto& entry : value.reshaped()) entry += std::complex<double>(part(random), part(random));
    value *= output_gain;
    set.variance.push_back(
        Eigen::MatrixXd::Constant(value.rows(), value.cols(), std::pow(noise * output_gain, 2)));
  }
  return set;
}

ResponseField field_of(const modal::FrfSet& responses, const Eigen::VectorXd& inputs,
                       const priors::Simulation& simulated = simulation()) {
  ResponseFieldPlan plan;
  plan.gains.is_supported = true;
  const auto modes = simulated.mode_count();
  auto outputs = places_at(sensors());
  auto there = places_at(inputs);
  outputs.shapes = outputs.shapes.leftCols(modes).eval();
  there.shapes = there.shapes.leftCols(modes).eval();
  return response_field(responses, simulated, outputs, there, plan);
}

struct Error {
  double relative = 0.0;   // rms of G(ρ) minus the truth, over the truth
  double deviation = 0.0;  // what the field says of it
};

Error error_of(const ResponseField& field, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs,
               double gain = 1.0) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(391, 10.0, 400.0);
  const auto found = field.at(places_at(x), lines);
  const auto real = truth(x, inputs, lines);
  double wrong = 0.0;
  double size = 0.0;
  double said = 0.0;
  for (std::size_t k = 0; k < found.value.size(); ++k) {
    wrong += (found.value[k] - gain * real.value[k]).squaredNorm();
    size += (gain * real.value[k]).squaredNorm();
    said += found.deviation[k].squaredNorm();
  }
  return {std::sqrt(wrong / size), std::sqrt(said / size)};
}

const Eigen::Vector2d kPairs(0.27, 1.07);            // at two of the sensors
const Eigen::Vector3d kBetween(0.19, 0.65, 1.31);    // no sensor there
const Eigen::Vector2d kWithoutSensor(0.335, 1.145);  // actuators between the sensors

TEST(ResponseField, IsTheBeamsBetweenTheSensors) {
  const auto field = field_of(responses_of(kPairs), kPairs);
  EXPECT_EQ(field.gains().pairs.size(), 2U);
  ASSERT_EQ(field.fit().model.mode_count(), 4);
  for (Eigen::Index m = 0; m < 4; ++m) {
    EXPECT_NEAR(field.fit().model.frequency_hz(m) / frequencies(20.0)(m), 1.0, 1e-4);
  }
  const auto error = error_of(field, kBetween, kPairs);
  EXPECT_LT(error.relative, 0.02);
  EXPECT_LT(error.relative, 3.0 * error.deviation);
  EXPECT_LT(error.deviation, 0.1);
}

// Actuators that push against the sensors' direction, as blows from above do.
TEST(ResponseField, KnowsActuatorsThatPushAgainstTheSensors) {
  auto responses = responses_of(kPairs);
  for (auto& input : responses.inputs) input.direction *= -1.0;
  for (auto& value : responses.value) value *= -1.0;
  auto inputs = places_at(kPairs);
  inputs.direction *= -1.0;
  inputs.shapes *= -1.0;
  ResponseFieldPlan plan;
  plan.gains.is_supported = true;
  const auto against = response_field(responses, simulation(), places_at(sensors()), inputs, plan);
  const auto plain = field_of(responses_of(kPairs), kPairs);
  EXPECT_TRUE(against.gains().match.warnings.empty());
  const double size = plain.shapes().values.norm();
  EXPECT_LT((against.shapes().values - plain.shapes().values).norm(), 1e-6 * size);
  EXPECT_LT((against.shapes().noise - plain.shapes().noise).norm(), 1e-6 * size);
  EXPECT_LT(error_of(against, kBetween, kPairs, -1.0).relative, 0.02);
}

// Actuators that count against the sensors: G(ρ) has the signs of the data, residual included.
TEST(ResponseField, HasTheSignsOfTheDataWhereActuatorsAreTurned) {
  auto responses = responses_of(kPairs);
  for (auto& value : responses.value) value *= -1.0;
  EXPECT_LT(error_of(field_of(responses, kPairs), kBetween, kPairs, -1.0).relative, 0.02);
}

// One channel of which no line is measured, of a pair or not: the others tell what they do without
// it.
TEST(ResponseField, LeavesOutAChannelThatWasNotMeasured) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Eigen::Index row : {4, 1}) {
    auto responses = responses_of(kPairs);
    for (auto& value : responses.value) value.row(row).setConstant({nan, nan});
    const auto field = field_of(responses, kPairs);
    EXPECT_EQ(field.shapes().mode_count(), 4);
    EXPECT_EQ(field.shapes().places.count(), 8);
    ASSERT_TRUE(field.shapes().sides.has_value());
    EXPECT_EQ(field.shapes().sides->actuator.size(), 8U);
    EXPECT_LT(field.shapes().noise.maxCoeff(), 0.02) << row;
    EXPECT_LT(error_of(field, kBetween, kPairs).relative, 0.03) << row;
  }
}

TEST(ResponseField, LearnsFromTheChannelsThatWereMeasured) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto responses = responses_of(kWithoutSensor);
  for (auto& value : responses.value) value.row(4).setConstant({nan, nan});
  const auto field = field_of(responses, kWithoutSensor);
  EXPECT_EQ(field.shapes().places.count(), 10);
  for (const auto& mode : field.gains().match.modes) EXPECT_EQ(mode.by, MatchedBy::prior);
  EXPECT_LT(error_of(field, kBetween, kWithoutSensor).relative, 0.05);
  const auto prior = simulated_gain_prior(field.fit(), simulation(), places_at(sensors()),
                                          places_at(kWithoutSensor));
  EXPECT_NE(prior.residual.eta, priors::DynamicResidual{}.eta);
}

// Without a pair the simulation tells the scale between forces and motions.
TEST(ResponseField, NeedsNoCollocatedPair) {
  const auto field = field_of(responses_of(kWithoutSensor), kWithoutSensor);
  EXPECT_TRUE(field.gains().pairs.empty());
  for (std::size_t m = 0; m < 4; ++m) {
    EXPECT_EQ(field.gains().match.modes[m].by, MatchedBy::prior) << m;
  }
  EXPECT_LT(error_of(field, kBetween, kWithoutSensor).relative, 0.05);
}

TEST(ResponseField, ScalesWithTheResponses) {
  const auto one = field_of(responses_of(kPairs), kPairs);
  const auto twice = field_of(responses_of(kPairs, 2.0), kPairs);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(40, 15.0, 390.0);
  const auto found = one.at(places_at(kBetween), lines);
  const auto double_found = twice.at(places_at(kBetween), lines);
  for (std::size_t k = 0; k < found.value.size(); ++k) {
    EXPECT_LT((double_found.value[k] - 2.0 * found.value[k]).norm(),
              2e-3 * double_found.value[k].norm());
  }
}

// Parts of Re G and Im G, over all lines from the second resonance on, that the 95 % band holds.
double held(const ResponseField& field, const priors::Places& places, const Eigen::VectorXd& x) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(331, 70.0, 400.0);
  const auto found = field.at(places, lines);
  const auto real = truth(x, kPairs, lines, kModes);
  double inside = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < found.value.size(); ++k) {
    const Eigen::ArrayXXcd off = (found.value[k] - real.value[k]).array();
    const Eigen::ArrayXXd reach = priors::kTwoSided95 / std::sqrt(2.0) * found.deviation[k].array();
    inside += static_cast<double>((off.real().abs() <= reach).count());
    inside += static_cast<double>((off.imag().abs() <= reach).count());
    count += 2.0 * static_cast<double>(off.size());
  }
  return inside / count;
}

// A simulation that ends with the band says nothing of the modes above it. The fit shows their sum
// at the sensors, and the band between them holds as much.
TEST(ResponseField, HasTheModesAboveTheBandInItsBand) {
  auto simulated = simulation();
  simulated.frequency_hz = simulated.frequency_hz.head(5).eval();
  simulated.surface.shapes = simulated.surface.shapes.leftCols(5).eval();
  simulated.frequency_hz(4) = 350.0;  // not above the band
  const auto responses = responses_of(kPairs, 1.0, kModes);
  const auto field = field_of(responses, kPairs, simulated);
  auto places = places_at(kBetween);
  places.shapes = places.shapes.leftCols(5).eval();
  EXPECT_GT(held(field, places, kBetween), 0.9);
}

// Responses that were not measured have no residual: the others tell the factor of the
// simulation's, and what it does not explain.
TEST(ResponseField, ScalesTheResidualByWhatWasMeasured) {
  const Eigen::MatrixXd outputs{{1.0, 0.5}, {-0.4, 1.2}, {0.7, -0.9}};
  const Eigen::MatrixXd inputs{{0.8, -0.3}, {1.1, 0.6}};
  const FieldSimulation simulation{{Eigen::Vector2d(300.0, 420.0), outputs, inputs}, {}, 200.0};
  const Eigen::VectorXd flexibility =
      (2.0 * std::numbers::pi * simulation.channels.frequency_hz).cwiseAbs2().cwiseInverse();
  ModalFit fit;
  fit.model.output_shapes.resize(3, 0);
  fit.model.input_shapes.resize(0, 2);
  ChannelGains gains;
  gains.match.shapes.resize(3, 0);
  gains.match.residual = 1.3 * outputs * flexibility.asDiagonal() * inputs.transpose();
  const priors::Places places{
      Points::Zero(1, 3), Points::Zero(1, 3), Eigen::MatrixXd{{1.0, 1.0}}, {}};
  const priors::Field field{Eigen::MatrixXd(1, 0), Eigen::MatrixXd(1, 0)};
  const Eigen::RowVectorXd there =
      1.3 * places.shapes * flexibility.asDiagonal() * inputs.transpose();
  for (const int gone : {0, 1, 3}) {
    auto& measured = gains.match.residual_known;
    if (gone > 0) measured.setConstant(3, 2, true);
    if (gone > 0) measured(1, 0) = false;
    if (gone > 1) measured(0, 0) = measured(2, 1) = false;
    // What stands where nothing was measured does not count.
    gains.match.residual(1, 0) = gone > 0 ? 0.3 : gains.match.residual(1, 0);
    EXPECT_NEAR(residual_factor(gains.match, simulation), 1.3, 1e-12) << gone;
    const auto found = places_of_interest(fit, gains, {}, simulation, places, field);
    EXPECT_LT((found.residual - there).norm(), 1e-12 * there.norm()) << gone;
    EXPECT_LT(found.residual_deviation.norm(), 1e-12 * there.norm()) << gone;
  }
}

// A fit knows the residuals of the responses that were measured; where it has none, that it is 0.
TEST(ResponseField, KnowsWhichResidualsWereMeasured) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto responses = responses_of(kPairs);
  for (auto& value : responses.value) value(1, 0) = value(6, 1) = {nan, nan};
  for (const bool residual : {true, false}) {
    IdentificationOptions options;
    options.fit.residual = residual;
    const auto fit = identified(fit_data(responses), options).fit;
    GainMatchOptions pairs;
    pairs.pairs = collocated_pairs(responses.outputs, responses.inputs, 1e-3);
    const auto match = gain_match(fit, responses.outputs, responses.inputs, pairs);
    Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> expected;
    expected.setConstant(9, 2, true);
    if (residual) expected(1, 0) = expected(6, 1) = false;
    EXPECT_TRUE((match.residual_known == expected).all()) << residual;
    EXPECT_EQ((match.residual.array() != 0.0).any(), residual);
  }
}

// A scale of unknown deviation is none that is certain: such a mode is left out.
TEST(ResponseField, LeavesOutAModeOfUnknownScale) {
  const auto field = field_of(responses_of(kPairs), kPairs);
  auto match = field.gains().match;
  const auto all = modes_with_scale(field.fit(), match);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_NO_THROW((void)with_scale_off(match, all, field.shapes()));
  for (const double unknown :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    match.modes[2].alpha_std = unknown;
    EXPECT_EQ(modes_with_scale(field.fit(), match), (std::vector<Eigen::Index>{0, 1, 3}));
    EXPECT_THROW((void)with_scale_off(match, all, field.shapes()), InvalidInput);
  }
}

// The gain of a sensor that no fit saw is as uncertain as those of the pairs differ.
TEST(ResponseField, HasTheGainOfAnUnseenSensorInItsBand) {
  ChannelGains gains;
  gains.match.pairs = {{1.1, 1e-3, false, 4}, {1.0 / 1.1, 1e-3, false, 4}};
  EXPECT_GT(gain_deviation(gains), std::log(1.1));
  EXPECT_LT(gain_deviation(gains), 0.25);
  gains.match.pairs = {{1.001, 1e-3, false, 4}, {0.999, 1e-3, false, 4}};
  EXPECT_EQ(gain_deviation(gains), 0.0);  // they agree
  gains.corrects_gains = true;
  EXPECT_GT(gain_deviation(gains), 0.05);  // the plan says that they are wrong
  const auto field = field_of(responses_of(kPairs), kPairs);
  const Eigen::VectorXd line = Eigen::VectorXd::Constant(1, 19.0);
  auto interest = places_of_interest(
      field.fit(), field.gains(), {0, 1, 2, 3},
      {{frequencies(20.6), sines(sensors()), sines(kPairs)}, sines(sensors()), 400.0},
      places_at(kBetween), {sines(kBetween).leftCols(4), Eigen::MatrixXd::Zero(3, 4)});
  EXPECT_EQ(interest.gain_deviation, 0.0);
  const auto known = predicted(field.fit(), field.gains().match, interest, line);
  interest.gain_deviation = 0.1;
  const auto unsure = predicted(field.fit(), field.gains().match, interest, line);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::pow(unsure.deviation[0](i, 0), 2),
                std::pow(known.deviation[0](i, 0), 2) + 0.01 * std::norm(known.value[0](i, 0)),
                1e-9 * std::norm(known.value[0](i, 0)));
  }
}

// A mode that takes no part is 0 with its size at the channels, whatever the unit of its factors.
TEST(ResponseField, HasModesWithoutAScaleInItsBand) {
  const auto field = field_of(responses_of(kPairs), kPairs);
  const FieldSimulation simulated{
      {frequencies(20.6), sines(sensors()), sines(kPairs)}, sines(sensors()), 400.0};
  const auto interest =
      places_of_interest(field.fit(), field.gains(), {0, 1, 3}, simulated, places_at(kBetween),
                         {sines(kBetween)(Eigen::all, {0, 1, 3}), Eigen::MatrixXd::Zero(3, 3)});
  EXPECT_EQ(interest.shapes.col(2).norm(), 0.0);
  const double size = sines(sensors()).col(2).norm() / 3.0;
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR(interest.deviation(i, 2), size, 0.02 * size);
  const Eigen::VectorXd line = Eigen::VectorXd::Constant(1, 180.0);
  const auto found = predicted(field.fit(), field.gains().match, interest, line);
  const auto real = truth(kBetween, kPairs, line);
  EXPECT_LT((found.value[0] - real.value[0]).norm(), 2.0 * found.deviation[0].norm());
  EXPECT_GT(found.deviation[0].norm(), 0.3 * real.value[0].norm());
}

// Shapes of channels that were not measured are 0, which makes no mode smaller.
TEST(ResponseField, TakesTheSizeOfAModeFromWhatWasMeasured) {
  const auto field = field_of(responses_of(kPairs), kPairs);
  const FieldSimulation simulated{
      {frequencies(20.6), sines(sensors()), sines(kPairs)}, sines(sensors()), 400.0};
  auto gains = field.gains();
  auto& match = gains.match;
  match.shapes.topRows(5).setZero();
  match.deviation.topRows(5).setConstant(std::numeric_limits<double>::infinity());
  const auto interest =
      places_of_interest(field.fit(), gains, {0, 1, 3}, simulated, places_at(kBetween),
                         {sines(kBetween)(Eigen::all, {0, 1, 3}), Eigen::MatrixXd::Zero(3, 3)});
  const Eigen::VectorXd rest = match.shapes.col(2).tail(match.shapes.rows() - 5);
  const double size = rest.norm() / std::sqrt(static_cast<double>(rest.size()));
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR(interest.deviation(i, 2), size, 1e-12);
}

TEST(ResponseFieldRefuses, PlacesThatDoNotFitTheChannels) {
  const auto responses = responses_of(kPairs);
  const auto message = refusal_of([&] {
    return response_field(responses, simulation(), places_at(kBetween), places_at(kPairs));
  });
  EXPECT_NE(message.find("simulated shapes of each of its channels"), std::string::npos) << message;
  auto blind = responses;
  blind.outputs[3].position.reset();
  const auto other = refusal_of([&] { return field_of(blind, kPairs); });
  EXPECT_NE(other.find("y4 has no place"), std::string::npos) << other;
}

}  // namespace
}  // namespace chladni::identification
