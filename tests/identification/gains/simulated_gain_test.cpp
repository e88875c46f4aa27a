// The scale of modes without a pair from a simulation that is corrected by the measured shapes:
// wafer tables that their model does not know.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/draw.h"
#include "identification/channel_gains.h"
#include "identification/gains/told_by_prior.h"
#include "rotation/turn.h"
#include "simulators/tables/plate_corrections.h"
#include "simulators/tables/plate_study.h"
#include "simulators/tables/real_tables.h"

namespace chladni::identification {
namespace {

constexpr int kTableModes = 12;
constexpr Eigen::Index kScaled = 9;
constexpr double kShapeNoise = 0.01;

// Sensors 120 mm from the nearest actuator.
Eigen::MatrixX2d sensors_between() {
  return Eigen::MatrixX2d{{-0.25, 0.12}, {0.12, 0.25}, {0.25, -0.12}, {-0.12, -0.25}};
}

struct Table {
  priors::Simulation simulation;  // of the minimal model, with its corrections
  priors::Places outputs, inputs;
  std::vector<modal::MeasuredChannel> sensors, actuators;
  ModalFit fit;
  Eigen::VectorXd log_beta;  // truth
};

std::vector<modal::MeasuredChannel> table_channels(const priors::Places& places) {
  std::vector<modal::MeasuredChannel> channels;
  for (Eigen::Index i = 0; i < places.count(); ++i) {
    modal::MeasuredChannel channel;
    channel.name = std::to_string(i + 1);
    channel.position = places.position.row(i).transpose();
    channel.direction = Eigen::Vector3d::UnitZ();
    channels.push_back(channel);
  }
  return channels;
}

// L = alpha phi and R = phi / alpha of a real table, with noise.
Table table(unsigned seed) {
  static const auto plate = simulators::minimal_table(25);
  static const auto believed = simulators::plate_modes(plate, 40);
  static const auto corrections = simulators::plate_corrections(plate, believed);
  const auto real = simulators::plate_modes(simulators::real_table(seed), kTableModes);
  const auto surface = simulators::plate_surface(real);
  const Eigen::MatrixX2d coils = simulators::layout("rings");
  Table made;
  made.simulation = simulators::plate_simulation(believed, surface);
  made.simulation.corrections = corrections;
  made.outputs = simulators::plate_places(believed, sensors_between());
  made.inputs = simulators::plate_places(believed, coils);
  made.sensors = table_channels(made.outputs);
  made.actuators = table_channels(made.inputs);
  Draw draw(500 + seed);
  const Eigen::VectorXd rms = simulators::unit_rms(
      simulators::shapes_at(real, surface.places).middleCols(3, kTableModes), surface.area);
  auto& model = made.fit.model;
  model.frequency_hz = real.frequency_hz.segment(3, kTableModes);
  model.damping_ratio = Eigen::VectorXd::Constant(kTableModes, 0.01);
  model.output_shapes =
      simulators::shapes_at(real, sensors_between()).middleCols(3, kTableModes) * rms.asDiagonal();
  model.input_shapes =
      (simulators::shapes_at(real, coils).middleCols(3, kTableModes) * rms.asDiagonal())
          .transpose();
  for (double& value : model.output_shapes.reshaped()) value += kShapeNoise * draw.normal();
  for (double& value : model.input_shapes.reshaped()) value += kShapeNoise * draw.normal();
  made.log_beta.resize(kTableModes);
  for (double& one : made.log_beta) one = 1.0 + draw.uniform();
  const Eigen::VectorXd alpha = (0.5 * made.log_beta.array()).exp();
  model.output_shapes = (model.output_shapes * alpha.asDiagonal()).eval();
  model.input_shapes = (alpha.cwiseInverse().asDiagonal() * model.input_shapes).eval();
  made.fit.output_std = kShapeNoise * alpha.transpose().replicate(4, 1);
  made.fit.input_std = kShapeNoise * alpha.cwiseInverse().replicate(1, coils.rows());
  model.residual = Eigen::MatrixXd::Zero(4, coils.rows());
  for (Eigen::Index m = 0; m < kTableModes; ++m) {
    Eigen::VectorXd square(2 + 4 + coils.rows());
    square << 0.0, 0.0, made.fit.output_std.col(m), made.fit.input_std.row(m).transpose();
    made.fit.mode_covariance.emplace_back(square.cwiseAbs2().asDiagonal());
  }
  return made;
}

GainMatch matched_by(const Table& made, const GainPrior& prior) {
  GainMatchOptions options;
  options.prior = prior;
  return gain_match(made.fit, made.sensors, made.actuators, options);
}

double log_beta_of(const ModeMatch& mode) { return 2.0 * std::log(mode.alpha); }
double deviation_of(const ModeMatch& mode) { return 2.0 * mode.alpha_std / mode.alpha; }

// Median of |ln beta - truth| over the tables and modes, and root mean square over its deviation.
struct Errors {
  std::vector<double> size, over_deviation;

  void add(const Table& made, const GainPrior& prior) {
    const auto match = matched_by(made, prior);
    for (Eigen::Index m = 0; m < kScaled; ++m) {
      const auto& mode = match.modes[static_cast<std::size_t>(m)];
      EXPECT_EQ(mode.by, MatchedBy::prior);
      EXPECT_EQ(mode.sign, 1);
      const double off = log_beta_of(mode) - made.log_beta(m);
      size.push_back(std::abs(off));
      over_deviation.push_back(off / deviation_of(mode));
    }
  }
  [[nodiscard]] double median() {
    std::ranges::nth_element(size, size.begin() + std::ssize(size) / 2);
    return size[size.size() / 2];
  }
  [[nodiscard]] double level() const {
    double square = 0.0;
    for (const double z : over_deviation) square += z * z;
    return std::sqrt(square / static_cast<double>(over_deviation.size()));
  }
};

GainPrior prior_of(const Table& made, bool corrected) {
  auto simulation = made.simulation;
  if (!corrected) simulation.corrections.clear();
  return simulated_gain_prior(made.fit, simulation, made.outputs, made.inputs);
}

// Seen over twenty tables: a median of 2.3 % of beta where the simulation is corrected, 7.6 % where
// it is taken as it is; errors of 1.03 deviations, and of 1.24 without what is doubtful of the
// corrections. Six tables say 0.94 and 1.14: chance moves such a level by about 0.1, so that only
// the ratio of the two, 1.15 to 1.3 of each table, tells that the doubts are there.
TEST(SimulatedGain, IsBetterWithTheCorrectedSimulationAndAsUncertainAsItIsSaidToBe) {
  EVERY_FOURTH_LANDING();
  Errors plain;
  Errors corrected;
  Errors without_doubt;
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const auto made = table(seed);
    plain.add(made, prior_of(made, false));
    auto prior = prior_of(made, true);
    EXPECT_GT(prior.aside.size(), 40U);
    corrected.add(made, prior);
    prior.aside.clear();
    without_doubt.add(made, prior);
  }
  EXPECT_LT(corrected.median(), 0.3 * plain.median());
  EXPECT_NEAR(plain.level(), 1.0, 0.2);
  EXPECT_NEAR(corrected.level(), 1.0, 0.2);
  EXPECT_GT(without_doubt.level(), 1.15 * corrected.level());
}

// The deviation is that of the evidence and what each simulation aside of the likeliest says.
TEST(SimulatedGain, MovesWithTheSimulationsAside) {
  const auto made = table(4);
  auto prior = prior_of(made, true);
  std::vector<GainPrior> some;
  for (std::size_t k = 0; k < prior.aside.size(); k += 12) some.push_back(prior.aside[k]);
  prior.aside = some;
  const auto match = matched_by(made, prior);
  auto certain = prior;
  certain.aside.clear();
  const auto middle = matched_by(made, certain);
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(kScaled);
  for (std::size_t k = 0; k < prior.aside.size(); ++k) {
    const auto moved = matched_by(made, prior.aside[k]);
    for (Eigen::Index m = 0; m < kScaled; ++m) {
      const auto mode = static_cast<std::size_t>(m);
      variance(m) += std::pow(log_beta_of(moved.modes[mode]) - log_beta_of(middle.modes[mode]), 2);
    }
  }
  for (Eigen::Index m = 0; m < kScaled; ++m) {
    const auto mode = static_cast<std::size_t>(m);
    EXPECT_EQ(match.modes[mode].alpha, middle.modes[mode].alpha);
    const double doubt = std::sqrt(std::pow(deviation_of(match.modes[mode]), 2) -
                                   std::pow(deviation_of(middle.modes[mode]), 2));
    EXPECT_GT(doubt, 0.0) << m;
    EXPECT_NEAR(doubt / std::sqrt(variance(m)), 1.0, 0.1) << m;
    // Half of it is in ln alpha, and thus in the shapes of both sides.
    EXPECT_GT(match.deviation(0, m), middle.deviation(0, m));
    EXPECT_GT(match.input_deviation(m, 0), middle.input_deviation(m, 0));
  }
}

// Sensors that hardly see a mode do not tell which way its actuators count.
TEST(SimulatedGain, HasAnUnknownSignInTheDeviationsOfTheActuators) {
  auto made = table(2);
  const auto prior = prior_of(made, true);
  const auto known = matched_by(made, prior);
  made.fit.model.output_shapes.col(4) *= 0.01;  // a hundredth, beside the noise of before
  const auto match = matched_by(made, prior);
  const auto says = [](const GainMatch& one) {
    return std::ranges::any_of(one.warnings, [](const std::string& warning) {
      return warning.find("mode 5 (") == 0 && warning.find("tells the sign") != std::string::npos;
    });
  };
  EXPECT_FALSE(says(known));
  EXPECT_TRUE(says(match));
  const auto relative = [](const GainMatch& one, Eigen::Index m) {
    return one.input_deviation.row(m).norm() / one.input_shapes.row(m).norm();
  };
  EXPECT_LT(relative(known, 4), 0.1);
  EXPECT_GT(relative(match, 4), 0.45);  // right with 95 %: 2 times the root of 0.05
  EXPECT_EQ(relative(match, 5), relative(known, 5));
}

// One that fails of the simulations aside is left out of the deviation, with a word.
TEST(SimulatedGain, LeavesOutASimulationAsideThatTellsNothing) {
  const auto made = table(2);
  auto prior = prior_of(made, true);
  prior.aside.resize(4);
  auto fewer = prior;
  fewer.aside.pop_back();
  prior.aside.back().outputs.shapes.setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto match = matched_by(made, prior);
  const auto without = matched_by(made, fewer);
  const auto& mode = match.modes[4];
  EXPECT_EQ(mode.by, MatchedBy::prior);
  EXPECT_DOUBLE_EQ(mode.alpha_std, without.modes[4].alpha_std);
  const auto says = [](const std::string& warning) {
    return warning.find("mode 5 (") == 0 &&
           warning.find(": 1 of 4 other plausible simulations") != std::string::npos;
  };
  EXPECT_EQ(std::ranges::count_if(match.warnings, says), 1);
  EXPECT_EQ(std::ranges::count_if(without.warnings, says), 0);
}

// A certainty below the limit is not told as the limit.
TEST(ToldByPrior, TellsACertaintyBelowTheLimitAsSuch) {
  const auto doubt = [](double certainty) {
    ToldByPrior told;
    told.gain.certainty = certainty;
    const auto all = doubts_of_told(told, 0);
    return all.empty() ? std::string{} : all.front();
  };
  EXPECT_NE(doubt(0.9499).find("of 94.9 % only"), std::string::npos) << doubt(0.9499);
  EXPECT_NE(doubt(0.5).find("of 50 % only"), std::string::npos) << doubt(0.5);
  EXPECT_EQ(doubt(0.95), "");
}

// A simulation that is far off altogether is no chance.
TEST(SimulatedGain, WarnsOfASimulationThatMayBeWrong) {
  auto made = table(2);
  made.fit.model.frequency_hz *= 4.0;
  const auto match = matched_by(made, prior_of(made, true));
  const auto is_gamma = [](const std::string& warning) {
    return warning.starts_with("the simulation, which scales modes without a pair: gamma");
  };
  EXPECT_EQ(std::ranges::count_if(match.warnings, is_gamma), 1);
}

}  // namespace
}  // namespace chladni::identification
