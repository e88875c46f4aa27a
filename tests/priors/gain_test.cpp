#include "priors/gain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/draw.h"
#include "base/error.h"
#include "plate_case.h"
#include "rotation/turn.h"

namespace chladni::priors {
namespace {

// Thirteen actuators, four sensors 100 mm from the nearest of them; truth from a real table.
TwoSidedShape seen_from_both_sides(unsigned table, Eigen::Index mode, double log_gain,
                                   unsigned seed, double noise = 0.01) {
  Eigen::MatrixX2d sensors(4, 2);
  sensors << -0.25, 0.25, 0.25, 0.25, 0.25, -0.25, -0.25, -0.25;
  const auto& real = table_modes(table);
  const auto actuators = simulators::layout("rings");
  TwoSidedShape shape;
  shape.frequency_hz = real.frequency_hz(3 + mode);
  shape.sensors = simulators::plate_places(minimal_modes(), sensors);
  shape.actuators = simulators::plate_places(minimal_modes(), actuators);
  shape.sensor_values = simulators::shapes_at(real, sensors).col(3 + mode);
  shape.actuator_values = simulators::shapes_at(real, actuators).col(3 + mode);
  const double rms = shape.actuator_values.norm() / std::sqrt(13.0);
  Draw draw(seed);
  for (double& value : shape.sensor_values) value += noise * rms * draw.normal();
  for (double& value : shape.actuator_values) value += noise * rms * draw.normal();
  const double alpha = std::exp(0.5 * log_gain);
  shape.sensor_values *= alpha;
  shape.actuator_values /= alpha;
  shape.sensor_noise = Eigen::VectorXd::Constant(4, alpha * noise * rms);
  shape.actuator_noise = Eigen::VectorXd::Constant(13, noise * rms / alpha);
  return shape;
}

ModalBasis basis_of_minimal() {
  const auto surface = simulators::plate_surface(minimal_modes());
  return modal_basis(simulators::plate_simulation(minimal_modes(), surface));
}

TEST(Gain, IsFoundWithoutAPair) {
  EVERY_FOURTH_LANDING();
  const auto basis = basis_of_minimal();
  std::vector<double> errors;
  for (const unsigned table : {1U, 2U, 3U}) {
    for (Eigen::Index mode = 0; mode < 5; ++mode) {
      const auto match = gain_match(seen_from_both_sides(table, mode, 0.8, 7 + table), basis);
      EXPECT_EQ(match.sign, 1);
      EXPECT_LT(std::abs(match.log_gain - 0.8), 4.0 * match.deviation + 1e-3);
      errors.push_back(std::abs(match.log_gain - 0.8));
    }
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);
}

TEST(Gain, FollowsTheSidesWhenTheyAreScaled) {
  const auto basis = basis_of_minimal();
  auto shape = seen_from_both_sides(1, 2, 0.3, 5);
  const auto match = gain_match(shape, basis);
  shape.sensor_values *= 10.0;
  shape.sensor_noise *= 10.0;
  shape.actuator_values /= 10.0;
  shape.actuator_noise /= 10.0;
  const auto scaled = gain_match(shape, basis);
  EXPECT_NEAR(scaled.log_gain, match.log_gain + 2.0 * std::log(10.0), 1e-4);
  EXPECT_NEAR(scaled.deviation, match.deviation, 1e-3 * match.deviation);
}

TEST(Gain, FindsAPolarityThatIsTurnedAround) {
  auto shape = seen_from_both_sides(1, 1, 0.5, 5);
  shape.sensor_values *= -1.0;
  const auto match = gain_match(shape, basis_of_minimal());
  EXPECT_EQ(match.sign, -1);
  EXPECT_GT(match.certainty, 0.99);
}

// One sensor, one actuator, one place: beta is L/R, and Var(ln beta) = (sigma_s^2 + sigma_a^2) /
// phi^2 in the shape's own unit, whatever the prior says of the shape.
TEST(Gain, OfASinglePairIsTheRatioOfItsValues) {
  auto shape = seen_from_both_sides(1, 0, 0.5, 5);
  shape.sensors = part(shape.actuators, {2});
  shape.actuators = part(shape.actuators, {2});
  const double phi = shape.actuator_values(2) * std::exp(0.25);
  const double alpha = std::exp(0.25);
  shape.sensor_values = Eigen::VectorXd::Constant(1, alpha * phi);
  shape.actuator_values = Eigen::VectorXd::Constant(1, phi / alpha);
  shape.sensor_noise = Eigen::VectorXd::Constant(1, 0.02 * alpha * std::abs(phi));
  shape.actuator_noise = Eigen::VectorXd::Constant(1, 0.01 * std::abs(phi) / alpha);
  const auto match = gain_match(shape, basis_of_minimal());
  EXPECT_EQ(match.sign, 1);
  EXPECT_NEAR(match.log_gain, 0.5, 0.1 * match.deviation);
  EXPECT_NEAR(match.deviation, std::hypot(0.02, 0.01), 0.1 * match.deviation);
}

// An actuator that pushes against the direction of its sensor is at its place all the same.
TEST(Gain, OfAPairThatLooksTheOtherWayIsThatOfAPair) {
  auto basis = basis_of_minimal();
  basis.beyond_square *= 30.0;  // much beyond the computed modes, which a pair shares
  auto shape = seen_from_both_sides(1, 4, 0.5, 5);
  const auto actuators = shape.actuators;
  shape.sensors = part(actuators, {2, 7});
  const double alpha = std::exp(0.25);
  shape.sensor_values = alpha * alpha * shape.actuator_values(std::vector<Eigen::Index>{2, 7});
  shape.sensor_noise = alpha * alpha * shape.actuator_noise.head(2);
  const auto along = gain_match(shape, basis);
  shape.actuators.direction *= -1.0;
  shape.actuators.shapes *= -1.0;
  shape.actuator_values *= -1.0;
  const auto against = gain_match(shape, basis);
  EXPECT_EQ(against.sign, along.sign);
  EXPECT_NEAR(against.log_gain, along.log_gain, 1e-9);
  EXPECT_NEAR(against.deviation, along.deviation, 1e-9);
  EXPECT_NEAR(against.log_evidence, along.log_evidence, 1e-9);
}

// Sensors that move three times as much in a second simulation make ln beta 2 ln 3 less: dozens of
// deviations away, where the evidence is nearly straight and a step of Newton goes anywhere.
TEST(Gain, NearThatOfAnotherSimulationIsItsOwnWhereverThatIs) {
  const auto basis = basis_of_minimal();
  for (Eigen::Index mode = 0; mode < 5; ++mode) {
    const auto shape = seen_from_both_sides(1, mode, 0.8, 8);
    const auto near = gain_match(shape, basis);
    EXPECT_NEAR(log_gain_near(shape, basis, {}, near), near.log_gain, 0.5 * near.deviation);
    for (const double times : {0.33, 0.98, 1.02, 3.0, 20.0}) {
      auto other = shape;
      other.sensors.shapes *= times;
      const auto own = gain_match(other, basis);
      EXPECT_NEAR(log_gain_near(other, basis, {}, near), own.log_gain, own.deviation)
          << mode << " " << times;
    }
  }
}

// A simulation that is no number, or that tells nothing since its sensors see only noise.
TEST(Gain, NearThatOfAnotherSimulationIsRefusedWhereThatTellsNone) {
  const auto basis = basis_of_minimal();
  auto shape = seen_from_both_sides(1, 2, 0.8, 8);
  const auto near = gain_match(shape, basis);
  shape.sensors.shapes.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW((void)log_gain_near(shape, basis, {}, near), NumericalFailure);
  auto unseen = seen_from_both_sides(1, 2, 0.8, 8);
  unseen.sensor_noise *= 1e4;
  EXPECT_THROW((void)log_gain_near(unseen, basis, {}, near), NumericalFailure);
}

TEST(Gain, RefusesASideThatIsMissingOrSeesNothing) {
  auto shape = seen_from_both_sides(1, 0, 0.5, 5);
  shape.sensor_values.setZero();
  EXPECT_THROW((void)gain_match(shape, basis_of_minimal()), InvalidInput);
  shape.sensor_values.resize(0);
  EXPECT_THROW((void)gain_match(shape, basis_of_minimal()), InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
