// G(ρ) of a pinned beam, whose modes are sines: responses between the sensors from arrays alone.
#include "identification/response_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/identification/rigs.h"
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

// Four modes: what modes above the band leave is no part of the stated deviation.
modal::Frf truth(const Eigen::VectorXd& outputs, const Eigen::VectorXd& inputs,
                 const Eigen::VectorXd& frequency_hz) {
  return modal::frf(model_of(frequencies(20.0).head(4), 0.01, sines(outputs).leftCols(4),
                             sines(inputs).leftCols(4).transpose()),
                    frequency_hz);
}

std::vector<modal::MeasuredChannel> channels_at(const std::string& letter,
                                                const Eigen::VectorXd& x) {
  auto result = channels(letter, x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    auto& channel = result[static_cast<std::size_t>(i)];
    channel.position = Eigen::Vector3d(x(i), 0.0, 0.0);
    channel.direction = Eigen::Vector3d::UnitZ();
  }
  return result;
}

// Responses up to between the fourth and the fifth mode, with noise of known variance.
modal::FrfSet responses_of(const Eigen::VectorXd& inputs, double output_gain = 1.0) {
  modal::FrfSet set;
  set.outputs = channels_at("y", sensors());
  set.inputs = channels_at("u", inputs);
  set.frequency_hz = Eigen::VectorXd::LinSpaced(1561, 10.0, 400.0);
  set.value = truth(sensors(), inputs, set.frequency_hz).value;
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

ResponseField field_of(const modal::FrfSet& responses, const Eigen::VectorXd& inputs) {
  ResponseFieldPlan plan;
  plan.gains.is_supported = true;
  return response_field(responses, simulation(), places_at(sensors()), places_at(inputs), plan);
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
