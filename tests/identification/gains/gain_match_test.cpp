#include "identification/gain_match.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/error.h"
#include "gain_case.h"
#include "identification/channel_gains.h"
#include "modal/frf.h"

namespace chladni::identification {
namespace {

TEST(GainMatch, ExtendsTwoSensorsByFourActuatorsExactly) {
  const auto made = two_by_four();
  for (const auto rule : {GainRule::thesis, GainRule::tied}) {
    auto options = with_pairs(made);
    options.rule = rule;
    const auto match = matched(made, rescaled(true_fit(made), kScales), options);
    ASSERT_EQ(match.rows.size(), 5U);  // 2 + 4 − 1
    const auto truth = truth_at(match, made.truth);
    for (Eigen::Index m = 0; m < 5; ++m) {
      const double sign = kScales(m) > 0.0 ? 1.0 : -1.0;
      EXPECT_LT((match.shapes.col(m) - sign * truth.col(m)).norm(), 1e-12 * truth.col(m).norm());
      EXPECT_NEAR(match.modes[static_cast<std::size_t>(m)].alpha, std::abs(kScales(m)),
                  1e-12 * std::abs(kScales(m)));
      EXPECT_EQ(match.modes[static_cast<std::size_t>(m)].by, MatchedBy::pairs);
    }
    EXPECT_TRUE(match.warnings.empty()) << match.warnings.front();
  }
}

TEST(GainMatch, PredictsTheSensorsThatAreNotThere) {
  const auto whole = simulators::beam5x5(quiet());
  const auto made = two_by_four();
  const auto fit = rescaled(true_fit(made), kScales);
  const auto match = matched(made, fit, with_pairs(made));
  const auto model = extended_model(fit, match);
  const auto known = modal::frf(model, whole.measured.frequency_hz);
  const std::vector<Eigen::Index> place = {1, 4, 0, 2, 3};  // y2 y5 u1 u3 u4
  for (std::size_t k = 0; k < known.value.size(); k += 50) {
    for (Eigen::Index row = 0; row < 5; ++row) {
      const auto wanted = whole.exact[k].row(place[static_cast<std::size_t>(row)]).head(4);
      EXPECT_LT((known.value[k].row(row) - wanted).norm(), 1e-10 * wanted.norm());
    }
  }
}

TEST(GainMatch, IsBlindToTheScaleBetweenBothSides) {
  const auto made = simulators::beam5x3(quiet());
  const auto fit = drawn_fit(true_fit(made), 4);
  for (const auto rule : {GainRule::thesis, GainRule::tied}) {
    auto options = with_pairs(made);
    options.rule = rule;
    const auto one = matched(made, fit, options);
    const auto other = matched(made, rescaled(fit, kScales), options);
    for (Eigen::Index m = 0; m < 5; ++m) {
      const double sign = kScales(m) > 0.0 ? 1.0 : -1.0;
      const double size = one.shapes.col(m).norm();
      EXPECT_LT((sign * other.shapes.col(m) - one.shapes.col(m)).norm(), 1e-10 * size);
      EXPECT_LT((other.deviation.col(m) - one.deviation.col(m)).norm(),
                1e-5 * one.deviation.col(m).norm());
    }
  }
}

// Root mean square error over draws, over what is stated.
struct Spread {
  Eigen::MatrixXd shapes, stated;
  Eigen::VectorXd alpha;
};

Spread spread_over_draws(const simulators::FrfCase& made, const GainMatchOptions& options,
                         int draws) {
  const auto fit = true_fit(made);
  const auto exact = matched(made, fit, options);
  const auto truth = truth_at(exact, made.truth);
  Spread spread{Eigen::MatrixXd::Zero(truth.rows(), truth.cols()), exact.deviation,
                Eigen::VectorXd::Zero(truth.cols())};
  for (int draw = 0; draw < draws; ++draw) {
    const auto match = matched(made, drawn_fit(fit, 100 + static_cast<unsigned>(draw)), options);
    spread.shapes += (match.shapes - truth).cwiseAbs2() / draws;
    for (Eigen::Index m = 0; m < truth.cols(); ++m) {
      const auto& mode = match.modes[static_cast<std::size_t>(m)];
      const double known = exact.modes[static_cast<std::size_t>(m)].alpha;
      spread.alpha(m) += std::pow((mode.alpha - known) / mode.alpha_std, 2) / draws;
    }
  }
  spread.shapes = spread.shapes.cwiseSqrt();
  spread.alpha = spread.alpha.cwiseSqrt();
  return spread;
}

TEST(GainMatch, StatesTheDeviationsOfAllRows) {
  constexpr int kDraws = 200;
  const double allowed = 4.5 / std::sqrt(2.0 * kDraws);
  for (const auto& made : {two_by_four(), simulators::beam5x3(quiet())}) {
    for (const auto rule : {GainRule::thesis, GainRule::tied}) {
      auto options = with_pairs(made);
      options.rule = rule;
      const auto spread = spread_over_draws(made, options, kDraws);
      const Eigen::ArrayXXd ratio = spread.shapes.cwiseQuotient(spread.stated);
      EXPECT_LT((ratio - 1.0).abs().maxCoeff(), allowed) << ratio;
      EXPECT_LT((spread.alpha.array() - 1.0).abs().maxCoeff(), allowed);
    }
  }
}

TEST(GainMatch, TiedIsNowhereWorseThanTheThesisRule) {
  const auto made = simulators::beam5x3(quiet());
  auto options = with_pairs(made);
  const auto tied = matched(made, true_fit(made), options);
  options.rule = GainRule::thesis;
  const auto thesis = matched(made, true_fit(made), options);
  EXPECT_TRUE((tied.deviation.array() < 1.001 * thesis.deviation.array()).all());
  EXPECT_LT(tied.deviation.sum(), 0.9 * thesis.deviation.sum());
  EXPECT_EQ(tied.modes[0].freedoms, 2);
}

TEST(GainMatch, LeavesAModeAloneWhosePairIsOnItsNode) {
  const auto made = part(simulators::beam5x5(quiet()), {2, 4}, {0, 1, 2, 3});  // the pair at 3
  for (unsigned seed = 0; seed < 5; ++seed) {
    const auto match = matched(made, drawn_fit(true_fit(made), seed), with_pairs(made));
    for (const Eigen::Index m : {0, 2, 4}) {
      EXPECT_EQ(match.modes[static_cast<std::size_t>(m)].by, MatchedBy::pairs);
      EXPECT_TRUE(match.deviation.col(m).allFinite());
    }
    for (const Eigen::Index m : {1, 3}) {
      EXPECT_EQ(match.modes[static_cast<std::size_t>(m)].by, MatchedBy::nothing);
      EXPECT_TRUE(match.shapes.col(m).allFinite());
      EXPECT_FALSE(match.deviation.col(m).array().isFinite().any());
    }
    ASSERT_EQ(match.warnings.size(), 2U);
    EXPECT_NE(match.warnings[0].find("mode 2 (5 Hz): every pair is near a node"),
              std::string::npos);
  }
}

TEST(GainMatch, NamesATurnedPair) {
  const auto made = simulators::beam5x3(quiet());
  auto fit = true_fit(made);
  fit.model.output_shapes.row(2) *= -1.0;  // y3
  const auto match = matched(made, fit, with_pairs(made));
  EXPECT_FALSE(match.pairs[0].turned);
  EXPECT_TRUE(match.pairs[1].turned);
  ASSERT_EQ(match.warnings.size(), 1U);
  EXPECT_NE(match.warnings[0].find("y3/u2"), std::string::npos);
  EXPECT_EQ(match.modes[0].sign, 1);
}

TEST(GainMatch, TurnsTheActuatorsWhereAllPairsAreTurned) {
  for (const auto& made : {two_by_four(), simulators::beam5x3(quiet())}) {
    auto fit = true_fit(made);
    fit.model.input_shapes *= -1.0;
    for (auto& covariance : fit.mode_covariance) {
      covariance.bottomRows(made.truth.input_count()) *= -1.0;
      covariance.rightCols(made.truth.input_count()) *= -1.0;
    }
    const auto match = matched(made, fit, with_pairs(made));
    ASSERT_EQ(match.warnings.size(), 1U);
    EXPECT_NE(match.warnings[0].find("turned around"), std::string::npos);
    EXPECT_EQ(match.modes[0].sign, -1);
    const auto truth = truth_at(match, made.truth);
    EXPECT_LT((match.shapes - truth).norm(), 1e-10 * truth.norm());
    const auto straight = matched(made, true_fit(made), with_pairs(made)).deviation;
    EXPECT_LT((match.deviation - straight).norm(), 1e-9 * straight.norm());
  }
}

// The chosen actuators act against the direction that they had, and so do their responses.
void turn_input(Eigen::Index j, simulators::FrfCase& made, ModalFit& fit) {
  made.measured.inputs[static_cast<std::size_t>(j)].direction *= -1.0;
  fit.model.input_shapes.col(j) *= -1.0;
  const auto place = 2 + fit.model.output_count() + j;
  for (auto& covariance : fit.mode_covariance) {
    covariance.row(place) *= -1.0;
    covariance.col(place) *= -1.0;
  }
}

TEST(GainMatch, TakesPairsOfOppositeDirectionsAsStated) {
  for (const auto& known : {two_by_four(), simulators::beam5x3(quiet())}) {
    for (const auto rule : {GainRule::thesis, GainRule::tied}) {
      const auto fit = drawn_fit(true_fit(known), 4);
      auto options = with_pairs(known);
      options.rule = rule;
      const auto plain = matched(known, fit, options);
      auto made = known;
      auto turned = fit;
      Eigen::VectorXd sign = Eigen::VectorXd::Ones(known.truth.input_count());
      for (Eigen::Index j = 0; j < sign.size(); ++j) {  // one after the other, at last all
        turn_input(j, made, turned);
        sign(j) = -1.0;
        options.pairs = with_pairs(made).pairs;
        const auto match = matched(made, turned, options);
        EXPECT_EQ(match.warnings, plain.warnings);
        EXPECT_EQ(match.modes[0].sign, 1);
        Eigen::MatrixXd shapes = plain.shapes;
        for (Eigen::Index k = known.truth.output_count(); k < shapes.rows(); ++k) {
          shapes.row(k) *= sign(match.rows[static_cast<std::size_t>(k)].channel);
        }
        EXPECT_LT((match.shapes - shapes).norm(), 1e-10 * shapes.norm());
        EXPECT_LT((match.input_shapes * sign.asDiagonal() - plain.input_shapes).norm(),
                  1e-10 * plain.input_shapes.norm());
        EXPECT_LT((match.deviation - plain.deviation).norm(), 1e-6 * plain.deviation.norm());
      }
    }
  }
}

TEST(GainMatch, KnowsTheSignOfPairsThatAreNamed) {
  auto made = two_by_four();
  GainPlan plan;
  plan.pairs = {{"y2", "u2"}};
  ASSERT_EQ(channel_pairs(plan, made.measured).size(), 1U);
  EXPECT_EQ(channel_pairs(plan, made.measured).front().sign, 1);
  made.measured.inputs[1].direction *= -1.0;
  EXPECT_EQ(channel_pairs(plan, made.measured).front().sign, -1);
}

// What the modes above the band add is turned and corrected with the modes.
TEST(GainMatch, GivesTheResidualTheSignAndTheGainsOfTheShapes) {
  const auto made = simulators::beam5x3(quiet());
  auto fit = true_fit(made);
  fit.model.residual = 1e-4 * fit.model.output_shapes.rightCols(1) * fit.model.input_shapes.row(2);
  const Eigen::MatrixXd truth = fit.model.residual;
  auto turned = with_turned_inputs(fit);
  turned.model.residual *= -1.0;
  const auto model = extended_model(turned, matched(made, turned, with_pairs(made)));
  EXPECT_LT((model.residual - truth).norm(), 1e-12 * truth.norm());
  const Eigen::VectorXd gain{{1.0, 1.0, 0.905, 1.0, 1.1}};
  fit.model.output_shapes = gain.asDiagonal() * fit.model.output_shapes;
  fit.model.residual = gain.asDiagonal() * truth;
  const double middle = std::cbrt(0.905 * 1.1);
  for (const auto fault : {GainFault::outputs, GainFault::inputs}) {
    auto options = with_pairs(made);
    options.fault = fault;
    const auto corrected = extended_model(fit, matched(made, fit, options));
    const std::vector<Eigen::Index> paired{0, 2, 4};
    const Eigen::MatrixXd found = corrected.residual(paired, Eigen::all);
    Eigen::MatrixXd wanted = middle * truth(paired, Eigen::all);
    if (fault == GainFault::inputs) {
      wanted = (gain(paired).asDiagonal() * truth(paired, Eigen::all) *
                (gain(paired) / middle).asDiagonal());
    }
    EXPECT_LT((found - wanted).norm(), 1e-8 * wanted.norm());
  }
}

TEST(GainMatch, FindsTheGainsOfThePairs) {
  auto faults = quiet();
  faults.output_gain = Eigen::VectorXd{{1.0, 1.0, 0.905, 1.0, 1.1}};
  const auto made = simulators::beam5x3(faults);
  auto mean = true_fit(made);
  mean.model.output_shapes = faults.output_gain.asDiagonal() * mean.model.output_shapes;
  const double middle = std::cbrt(0.905 * 1.1);
  const Eigen::Vector3d known = Eigen::Vector3d(1.0, 0.905, 1.1) / middle;
  Eigen::Vector3d square = Eigen::Vector3d::Zero();
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto fit = drawn_fit(mean, static_cast<unsigned>(draw));
    const auto match = matched(made, fit, with_pairs(made));
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto& gain = match.pairs[static_cast<std::size_t>(c)];
      EXPECT_LT(gain.ratio_std, 2e-3);
      square(c) += std::pow((gain.ratio - known(c)) / gain.ratio_std, 2) / kDraws;
    }
  }
  EXPECT_LT((square.cwiseSqrt().array() - 1.0).abs().maxCoeff(), 4.5 / std::sqrt(2.0 * kDraws));
  const auto match = matched(made, mean, with_pairs(made));
  EXPECT_GE(match.warnings.size(), 3U);  // the gains, and the pairs that disagree
  auto options = with_pairs(made);
  options.fault = GainFault::outputs;
  const auto corrected = matched(made, mean, options);
  const Eigen::MatrixXd symmetric =
      corrected.shapes(std::vector<Eigen::Index>{0, 2, 4}, Eigen::all) -
      corrected.input_shapes.transpose();
  EXPECT_LT(symmetric.norm(), 1e-10 * corrected.shapes.norm());
}

// Pairs that are not what they are said to be may not turn the inputs: the response to them is
// known.
TEST(GainMatch, KeepsTheRowsOfAModeWhosePairsContradictEachOther) {
  auto faults = quiet();
  faults.output_gain = Eigen::VectorXd{{1.0, 1.0, 0.7, 1.0, 1.4}};
  const auto made = simulators::beam5x3(faults);
  auto fit = true_fit(made);
  fit.model.output_shapes = faults.output_gain.asDiagonal() * fit.model.output_shapes;
  const auto match = matched(made, fit, with_pairs(made));
  int contradictions = 0;
  for (Eigen::Index m = 0; m < fit.model.mode_count(); ++m) {
    const auto& mode = match.modes[static_cast<std::size_t>(m)];
    if (!contradicted(mode)) continue;
    ++contradictions;
    EXPECT_LT((mode.alpha * fit.model.input_shapes.row(m) - match.input_shapes.row(m)).norm(),
              1e-12 * match.input_shapes.row(m).norm());
    EXPECT_GT(mode.alpha_std / mode.alpha, 0.01);  // what they scatter by
  }
  EXPECT_GE(contradictions, 2);
}

TEST(GainMatch, CorrectsAPairThatIsApartByTheSimulatedShapes) {
  const auto whole = simulators::beam5x5(quiet());
  const auto made = part(whole, {1, 4}, {0, 2, 3});  // y2 lies 100 mm from u1 and u3
  auto options = with_pairs(made);
  ASSERT_TRUE(options.pairs.empty());
  options.pairs = {
      {0, 0, whole.truth.output_shapes.row(1).transpose(), whole.truth.input_shapes.col(0)}};
  options.simulation_error = 0.01;
  const auto match = matched(made, rescaled(true_fit(made), kScales), options);
  ASSERT_EQ(match.rows.size(), 5U);  // both of the pair keep their row
  const auto truth = truth_at(match, made.truth);
  for (Eigen::Index m = 0; m < 5; ++m) {
    const double sign = kScales(m) > 0.0 ? 1.0 : -1.0;
    EXPECT_LT((match.shapes.col(m) - sign * truth.col(m)).norm(), 1e-10 * truth.col(m).norm());
  }
  // The simulation's own error is in the deviations: α is known to a part of the change.
  const double there = whole.truth.output_shapes(1, 4);
  const double here = whole.truth.input_shapes(4, 0);
  const double ratio_error = 0.01 * std::abs(there - here) * std::hypot(1.0 / there, 1.0 / here);
  EXPECT_NEAR(match.modes[4].alpha_std / match.modes[4].alpha, 0.5 * ratio_error,
              0.1 * ratio_error);
}

// A tenth of the change may be wrong at either place: as much as the whole of a small shape.
TEST(GainMatch, LeavesAModeAloneThatTheSimulationPutsNearANodeOfEitherPlace) {
  const auto made = two_by_four();
  const auto fit = true_fit(made);
  for (const bool at_sensor : {true, false}) {
    auto options = with_pairs(made);
    auto& pair = options.pairs.front();
    pair.at_output = Eigen::VectorXd::Ones(5);
    pair.at_input = Eigen::VectorXd::Ones(5);
    (at_sensor ? pair.at_output : pair.at_input)(3) = 0.05;
    const auto match = matched(made, fit, options);
    EXPECT_EQ(match.modes[2].by, MatchedBy::pairs);
    EXPECT_EQ(match.modes[3].by, MatchedBy::nothing);
  }
}

TEST(GainMatch, RefusesWhatDoesNotFit) {
  const auto made = simulators::beam5x3(quiet());
  const auto fit = true_fit(made);
  auto options = with_pairs(made);
  options.pairs[1].output = options.pairs[0].output;
  EXPECT_THROW((void)matched(made, fit, options), InvalidInput);
  options = with_pairs(made);
  options.pairs[2].input = 3;
  EXPECT_THROW((void)matched(made, fit, options), InvalidInput);
  options = with_pairs(made);
  options.pairs[0].at_output = Eigen::VectorXd::Ones(4);
  EXPECT_THROW((void)matched(made, fit, options), InvalidInput);
  options = with_pairs(made);
  options.geometry = geometry_of(made, RigidMotion::beam);
  options.geometry->suspended = {5};
  EXPECT_THROW((void)matched(made, fit, options), InvalidInput);
  EXPECT_THROW((void)gain_match(fit, made.measured.inputs, made.measured.inputs, with_pairs(made)),
               InvalidInput);
}

TEST(GainMatch, FindsPairsByTheirPlaces) {
  const auto made = simulators::oat4x13(quiet());
  EXPECT_TRUE(collocated_pairs(made.measured.outputs, made.measured.inputs, 0.05).empty());
  const auto pairs = collocated_pairs(made.measured.outputs, made.measured.inputs, 0.11);
  ASSERT_EQ(pairs.size(), 4U);  // "around 100 mm away, a1 to a4"
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_EQ(pairs[c].output, static_cast<Eigen::Index>(c));
    EXPECT_EQ(pairs[c].input, static_cast<Eigen::Index>(c));
  }
}

// A triaxial sensor, and an actuator that presses against the other face.
TEST(GainMatch, PairsOnlyChannelsThatActAlongOneLine) {
  modal::FrfSet set;
  for (int axis = 0; axis < 3; ++axis) {
    modal::MeasuredChannel sensor;
    sensor.name = "y" + std::to_string(axis + 1);
    sensor.direction = Eigen::Vector3d::Unit(axis);
    sensor.position = Eigen::Vector3d::Zero();
    set.outputs.push_back(sensor);
  }
  modal::MeasuredChannel actuator;
  actuator.name = "u1";
  actuator.direction = -Eigen::Vector3d::UnitZ();
  actuator.position = Eigen::Vector3d(0.0, 0.0, -0.01);
  set.inputs = {actuator};
  const auto pairs = channel_pairs({}, set);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].output, 2);
  EXPECT_EQ(pairs[0].sign, -1);
  set.outputs.pop_back();
  EXPECT_TRUE(channel_pairs({}, set).empty());
}

}  // namespace
}  // namespace chladni::identification
