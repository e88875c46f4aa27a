#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/effect.h"
#include "diagnosis/modes/proposals/next_measurement.h"
#include "rotation/turn.h"
#include "simulators/portable_random.h"
#include "tests/diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using simulators::Dice;
using What = Proposal::What;

Forecast known(VectorXd mean) {
  const Index n = mean.size();
  return {std::move(mean), MatrixXd(n, 0)};
}

TEST(Separation, IsHalfTheSquaredDistanceOfForecastsThatAreKnown) {
  const VectorXd variance = Vector3d(4.0, 1.0, 0.25);
  const double apart =
      separation(known(Vector3d(1.0, 2.0, 3.0)), known(Vector3d(3.0, 2.0, 2.0)), variance);
  EXPECT_NEAR(apart, 0.5 * (1.0 + 0.0 + 4.0), 1e-12);
}

// The mean of ln p(y|a) - ln p(y|b) over draws of a measurement, if a is true.
TEST(Separation, IsWhatDrawsOfTheMeasurementBring) {
  Dice dice(3);
  const Index n = 4;
  const Forecast a{dice.normal(n, 1), 0.7 * dice.normal(n, 2)};
  const Forecast b{a.mean + dice.normal(n, 1), a.spread};
  const VectorXd variance = Eigen::Vector4d(0.3, 1.0, 2.0, 0.5);
  const MatrixXd covariance = MatrixXd(variance.asDiagonal()) + a.spread * a.spread.transpose();
  const Eigen::LLT<MatrixXd> factor(covariance);
  double sum = 0.0;
  const int draws = 20000;
  for (int draw = 0; draw < draws; ++draw) {
    const VectorXd y = a.mean + factor.matrixL() * VectorXd(dice.normal(n, 1));
    sum += 0.5 * ((y - b.mean).dot(factor.solve(y - b.mean)) -
                  (y - a.mean).dot(factor.solve(y - a.mean)));
  }
  const double expected = separation(a, b, variance);
  EXPECT_GT(expected, 0.3);
  EXPECT_NEAR(sum / draws, expected, 5.0 * std::sqrt(2.0 * expected / draws));
}

TEST(Separation, IsSymmetricAndZeroForOneForecast) {
  Dice dice(4);
  const Forecast a{dice.normal(3, 1), dice.normal(3, 1)};
  const Forecast b{dice.normal(3, 1), 2.0 * dice.normal(3, 2)};
  const VectorXd variance = VectorXd::Ones(3);
  EXPECT_NEAR(separation(a, b, variance), separation(b, a, variance), 1e-12);
  EXPECT_NEAR(separation(a, a, variance), 0.0, 1e-12);
  EXPECT_GT(separation(a, b, variance), 0.0);
}

TEST(Separation, FallsWhereASizeIsNotCertain) {
  const VectorXd variance = VectorXd::Ones(2);
  const Forecast certain = known(Eigen::Vector2d(0.0, 0.0));
  const Forecast a = known(Eigen::Vector2d(5.0, 0.0));
  const Forecast wide{a.mean, MatrixXd(Eigen::Vector2d(5.0, 0.0))};
  const Forecast aside{a.mean, MatrixXd(Eigen::Vector2d(0.0, 0.1))};
  EXPECT_LT(separation(certain, wide, variance), separation(certain, a, variance));
  EXPECT_NEAR(separation(certain, aside, variance), separation(certain, a, variance), 0.1);
}

TEST(Separation, LeavesOutWhatOneOfThemDoesNotForetell) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const VectorXd variance = VectorXd::Ones(2);
  EXPECT_NEAR(
      separation(known(Eigen::Vector2d(2.0, none)), known(Eigen::Vector2d(0.0, 9.0)), variance),
      2.0, 1e-12);
  EXPECT_EQ(
      separation(known(VectorXd::Constant(1, none)), known(VectorXd::Zero(1)), VectorXd::Ones(1)),
      0.0);
}

struct Hidden {
  std::string_view effect;
  Index option = 0;
  VectorXd x;
};

// The first ten modes of the small plate with an effect: frequencies and shapes at its sensors.
MeasuredModes modes_with(const std::vector<Hidden>& hidden, unsigned seed) {
  State state = state_of(small_plate());
  for (const auto& one : hidden) {
    effect(one.effect).apply(state, small_plate(), one.option, one.x);
  }
  const auto exact =
      ModeSolver(state_of(small_plate()), small_plate().mode_count()).modes(state, 20.0, 1e5);
  const Index m = 10;
  Dice dice(seed);
  MeasuredModes modes;
  modes.outputs = small_plate().outputs.names;
  modes.frequency_hz = exact.frequency_hz.head(m);
  for (double& hz : modes.frequency_hz) hz *= std::exp(1e-4 * dice.normal());
  std::sort(modes.frequency_hz.begin(), modes.frequency_hz.end());
  modes.frequency_std = VectorXd::Constant(m, 1e-4);
  modes.damping_ratio = VectorXd::Constant(m, std::numeric_limits<double>::quiet_NaN());
  modes.damping_std = VectorXd::Ones(m);
  const MatrixXd clean =
      exact.output_path.real().leftCols(m).cwiseProduct(exact.outputs.leftCols(m));
  const double size = clean.norm() / std::sqrt(static_cast<double>(clean.size()));
  const MatrixXd noise = 0.005 * size * dice.normal(clean.rows(), m);
  modes.output_shapes = clean + noise;
  modes.output_std = MatrixXd::Constant(clean.rows(), m, 0.005 * size);
  modes.input_shapes.resize(0, m);
  modes.input_std.resize(0, m);
  return modes;
}

Diagnosis asked(const MeasuredModes& modes, std::vector<std::string> only,
                const MeasurementCosts& costs = {}) {
  DiagnosisOptions options;
  options.only = std::move(only);
  options.costs = costs;
  return diagnosed(small_plate(), modes, options);
}

const Proposal* find(const Diagnosis& diagnosis, What what) {
  const auto found = std::ranges::find(diagnosis.proposals, what, &Proposal::what);
  return found == diagnosis.proposals.end() ? nullptr : &*found;
}

// Modes without a scale do not tell a softer body from a heavier one; scales do.
TEST(NextMeasurement, WeighsWhatIsSoftOrHeavy) {
  const auto found = asked(modes_with({{"density", 0, VectorXd::Constant(1, 0.12)}}, 1),
                           {"density", "youngs_modulus"});
  ASSERT_EQ(found.verdict, Verdict::ambiguous);
  ASSERT_NE(find(found, What::weighing), nullptr) << found.measure_next;
  EXPECT_EQ(find(found, What::sensor), nullptr);
  EXPECT_EQ(found.proposals.front().what, What::mass) << found.measure_next;
}

// Scales settle nearly all of the doubt; a third explanation of little weight weighs the same as
// the first.
TEST(NextMeasurement, WeighsBesideARivalOfLittleWeight) {
  const auto modes = modes_with({{"youngs_modulus", 0, VectorXd::Constant(1, 0.06)}}, 1);
  const ModesProblem problem(small_plate(), modes, Tolerances{}, true);
  const auto fit = [&](std::string_view name, const VectorXd& x) {
    ModesFit start = problem.nothing();
    start.causes.push_back({&effect(name), 0, x});
    return problem.fitted(start);
  };
  const auto stiffer = fit("youngs_modulus", VectorXd::Constant(1, 0.06));
  const auto lighter = fit("density", VectorXd::Constant(1, -0.06));
  auto other = stiffer;
  other.log_evidence -= 3.0;
  const auto proposed = [&](double of_other) {
    const auto all = next_measurements(
        problem, {{&stiffer, 0.52 - of_other}, {&lighter, 0.48}, {&other, of_other}},
        MeasurementCosts{});
    return std::ranges::find(all, What::weighing, &Proposal::what) != all.end();
  };
  EXPECT_TRUE(proposed(0.0));
  EXPECT_TRUE(proposed(0.03));
  EXPECT_FALSE(proposed(0.25));
}

TEST(NextMeasurement, TakesTheCostsOfTheUser) {
  const auto modes = modes_with({{"density", 0, VectorXd::Constant(1, 0.12)}}, 1);
  const MeasurementCosts costs{.mass = 20.0, .weighing = 0.1};
  const auto found = asked(modes, {"density", "youngs_modulus"}, costs);
  ASSERT_FALSE(found.proposals.empty());
  EXPECT_EQ(found.proposals.front().what, What::weighing) << found.measure_next;
  EXPECT_NE(found.measure_next.find("weigh"), std::string::npos);
}

// A thicker plate and a stiffer one: a dimension tells them apart.
TEST(NextMeasurement, MeasuresWhatIsThickOrStiff) {
  const auto found = asked(modes_with({{"thickness", 0, VectorXd::Constant(1, 0.05)}}, 2),
                           {"thickness", "youngs_modulus"});
  ASSERT_FALSE(found.proposals.empty());
  const auto* dimension = find(found, What::dimension);
  ASSERT_NE(dimension, nullptr) << found.measure_next;
  EXPECT_EQ(dimension->of, "the thickness");
}

// A sensor that reads a tenth less is told from everything else by another one in its place.
TEST(NextMeasurement, ExchangesAChannelThatIsBlamed) {
  const auto found = asked(modes_with({{"sensor_gain", 3, VectorXd::Constant(1, 0.25)}}, 3), {});
  ASSERT_FALSE(found.best.causes.empty());
  const auto* exchange = find(found, What::exchange);
  ASSERT_NE(exchange, nullptr) << found.measure_next;
  EXPECT_EQ(exchange->of, small_plate().outputs.names[3]);
}

TEST(NextMeasurement, IsNoneWhereNothingIsWrong) {
  const auto found = asked(modes_with({}, 4), {});
  ASSERT_EQ(found.verdict, Verdict::no_discrepancy);
  EXPECT_TRUE(found.measure_next.empty());
  EXPECT_TRUE(found.proposals.empty());
}

TEST(NextMeasurement, IsAlwaysToldWhereSomethingIsWrong) {
  EVERY_FOURTH_LANDING();
  for (const std::string_view effect : {"point_mass", "youngs_modulus", "sensor_sign"}) {
    const auto& record = diagnosis::effect(effect);
    VectorXd x = VectorXd::Zero(static_cast<Index>(record.parameters(small_plate()).size()));
    if (effect == "youngs_modulus") x(0) = -0.2;
    if (effect == "point_mass") x = Vector3d(0.4, 0.11, 0.07);
    const auto found = asked(modes_with({{effect, 2 * (effect == "sensor_sign"), x}}, 5), {});
    EXPECT_NE(found.verdict, Verdict::no_discrepancy) << effect;
    EXPECT_FALSE(found.measure_next.empty()) << effect;
  }
}

}  // namespace
}  // namespace chladni::diagnosis
