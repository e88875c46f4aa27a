#include "identification/matrix_fraction.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "identification/fraction/fraction_equations.h"
#include "identification/fraction/unrest.h"
#include "identification/identified.h"
#include "modal/mac.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"
#include "simulators/portable_random.h"

namespace chladni::identification {
namespace {

using std::numbers::pi;

simulators::FrfFaults noiseless() {
  simulators::FrfFaults faults;
  faults.noisy = false;
  return faults;
}

// The weights of a case, without the reader's own smoothing in between.
FitData data_of(const simulators::FrfCase& made) {
  const auto& measured = made.measured;
  FitData data;
  data.outputs = measured.output_count();
  data.inputs = measured.input_count();
  data.frequency_hz = measured.frequency_hz;
  const auto pq = data.outputs * data.inputs;
  data.value.resize(measured.line_count(), pq);
  data.weight.resize(measured.line_count(), pq);
  for (Eigen::Index k = 0; k < measured.line_count(); ++k) {
    const auto line = static_cast<std::size_t>(k);
    data.value.row(k) = measured.value[line].reshaped().transpose();
    data.weight.row(k) = measured.variance[line].reshaped().cwiseSqrt().cwiseInverse().transpose();
  }
  return data;
}

double relative_error(const FitData& data, const Eigen::MatrixXcd& value) {
  return ((data.value - value).array() * data.weight.array()).matrix().norm() /
         (data.value.array() * data.weight.array()).matrix().norm();
}

Eigen::VectorXcd true_poles(const modal::ReducedModel& truth) {
  const Eigen::ArrayXd omega = 2.0 * pi * truth.frequency_hz.array();
  Eigen::VectorXcd pole(omega.size());
  pole.real() = -truth.damping_ratio.array() * omega;
  pole.imag() = omega * (1.0 - truth.damping_ratio.array().square()).sqrt();
  return pole;
}

// The largest |p − p₀| / |p₀| over the true poles and those next to them.
double pole_error(const Eigen::VectorXcd& found, const Eigen::VectorXcd& truth) {
  double worst = 0.0;
  for (const auto& pole : truth) {
    worst = std::max(worst, (found.array() - pole).abs().minCoeff() / std::abs(pole));
  }
  return worst;
}

TEST(PolynomialBasis, IsOrthonormalOnTheLinesAtAnyDegree) {
  simulators::Dice dice(2);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(2000, 0.001, 1.0);
  Eigen::VectorXd weight(2000);
  for (double& w : weight) w = dice.between(0.1, 30.0);
  const auto basis = orthonormal_basis(x, weight, 60);
  const Eigen::MatrixXcd phi = weight.asDiagonal() * values(basis, x);
  const Eigen::MatrixXd gram = (phi.adjoint() * phi).real();
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(61, 61)).norm(), 1e-9);
}

TEST(MatrixFraction, IsExactOnDataWithoutNoise) {
  for (const auto& made : {simulators::beam5x3(noiseless()), simulators::beam5x5(noiseless())}) {
    const auto data = data_of(made);
    for (const Eigen::Index numerator : {0, 2}) {
      MatrixFractionOptions options;
      options.numerator_degree = numerator;
      const auto fraction = matrix_fraction(data, options);
      EXPECT_LT(relative_error(data, responses(fraction, data.frequency_hz)), 1e-9);
      EXPECT_LT(pole_error(poles(fraction), true_poles(made.truth)), 1e-9);
      EXPECT_EQ(poles(fraction).size(), 10);
    }
  }
}

// Thesis (5.6): a point mass, driven and seen in two directions: G = I / (m s²).
TEST(MatrixFraction, OfAPointMassHasItsFourPolesAtZero) {
  modal::ReducedModel model;
  model.rigid_count = 2;
  model.frequency_hz = model.damping_ratio = Eigen::Vector2d::Zero();
  model.output_shapes = model.input_shapes = Eigen::Matrix2d::Identity() / std::sqrt(2.0);
  simulators::FrfGrid grid;
  grid.outputs = grid.inputs = Eigen::MatrixX3d::Identity(2, 3);
  grid.frequency_hz = Eigen::VectorXd::LinSpaced(100, 1.0, 100.0);
  auto faults = noiseless();
  faults.relative_noise = 0.0;  // 0 / 0 off the diagonal
  faults.floor_noise = 0.01;
  auto made = simulators::frf_case(model, grid, faults);
  for (auto& variance : made.measured.variance) variance.setConstant(1e-8);
  const auto data = data_of(made);
  const auto fraction = matrix_fraction(data, {2, 0, 30, 10, {}});
  EXPECT_LT(relative_error(data, responses(fraction, data.frequency_hz)), 1e-10);
  EXPECT_EQ(poles(fraction).size(), 4);
  EXPECT_LT(poles(fraction).cwiseAbs().maxCoeff(), 1e-3 * 2.0 * pi * 100.0);
  const auto start = thesis_start(data, {.modes = 0, .rigid_count = 2});
  EXPECT_EQ(start.pole.size(), 0);
  EXPECT_EQ(start.rigid_count, 2);
}

TEST(MatrixFraction, KeepsItsBestIterateAndOnlyDescendsAfterIt) {
  simulators::FrfFaults faults;
  faults.relative_noise = 0.05;
  const auto data = data_of(simulators::beam5x3(faults));
  MatrixFractionOptions options;
  options.numerator_degree = 0;
  options.levenberg_marquardt = 40;  // 10 do not suffice here
  const auto fraction = matrix_fraction(data, options);
  ASSERT_GE(fraction.costs.size(), 31U);
  const auto middle = fraction.costs.begin() + 30;
  const double best = *std::min_element(fraction.costs.begin(), middle);
  double last = best;
  for (auto cost = middle; cost != fraction.costs.end(); ++cost) {
    EXPECT_LT(*cost, last);
    last = *cost;
  }
  EXPECT_EQ(fraction.cost, last);
  EXPECT_NEAR(fraction.cost,
              std::pow(relative_error(data, responses(fraction, data.frequency_hz)) *
                           (data.value.array() * data.weight.array()).matrix().norm(),
                       2),
              1e-9 * fraction.cost);
  // What noise leaves: numbers less the 65 coefficients, halved.
  EXPECT_NEAR(fraction.cost / (0.5 * static_cast<double>(data.measured_count() - 65)), 1.0, 0.03);
}

TEST(MatrixFraction, StaysFiniteOverTheHundredIterationsOfTheThesis) {
  const auto data = data_of(simulators::beam5x3());
  const auto fraction = matrix_fraction(data, {2, 0, 100, 0, {}});
  ASSERT_EQ(fraction.costs.size(), 100U);
  for (const double cost : fraction.costs) EXPECT_TRUE(std::isfinite(cost));
  EXPECT_NEAR(fraction.costs.back(), fraction.costs[50], 0.01 * fraction.cost);
}

TEST(MatrixFraction, DoesNotDependOnTheUnits) {
  const auto data = data_of(simulators::beam5x3());
  auto other = data;
  other.frequency_hz *= 1e4;
  other.value *= 1e-9;
  other.weight *= 1e9;
  MatrixFractionOptions options;
  options.sanathanan_koerner = 10;
  options.levenberg_marquardt = 3;
  const auto one = matrix_fraction(data, options);
  const auto two = matrix_fraction(other, options);
  EXPECT_NEAR(one.cost, two.cost, 1e-6 * one.cost);
  EXPECT_LT(pole_error(poles(two) / 1e4, poles(one)), 1e-6);
}

TEST(ThesisStart, HasResiduesOfRankOneAtTheTruePoles) {
  const auto made = simulators::beam5x3(noiseless());
  const auto start = thesis_start(data_of(made), {.modes = 5});
  ASSERT_EQ(start.pole.size(), 5);
  EXPECT_LT(pole_error(start.pole, true_poles(made.truth)), 1e-9);
  for (Eigen::Index m = 0; m < 5; ++m) {
    const Eigen::MatrixXd known = made.truth.output_shapes.col(m) * made.truth.input_shapes.row(m);
    const auto& residue = start.residue[static_cast<std::size_t>(m)];
    EXPECT_LT((residue - known).norm(), 1e-7 * known.norm());
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(residue);
    EXPECT_LT(svd.singularValues()(1), 1e-14 * svd.singularValues()(0));
  }
}

TEST(ThesisFit, FindsTheModesOfTheBeamNearTheBound) {
  const auto made = simulators::beam5x3();
  const auto data = data_of(made);
  const auto fit = thesis_fit(data, {.modes = 5});
  const auto bounds = simulators::cramer_rao(made);
  ASSERT_EQ(fit.model.mode_count(), 5);
  for (Eigen::Index m = 0; m < 5; ++m) {
    EXPECT_LT(std::abs(fit.model.frequency_hz(m) - made.truth.frequency_hz(m)),
              4.0 * bounds.frequency_hz(m))
        << m;
    EXPECT_LT(std::abs(fit.model.damping_ratio(m) - made.truth.damping_ratio(m)),
              4.0 * bounds.damping(m))
        << m;
  }
}

// The beam without single values, responses or a sensor: all modes are there as before.
std::vector<simulators::FrfCase> beams_with_gaps() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  simulators::FrfFaults faults;
  faults.missing = 0.1;
  std::vector<simulators::FrfCase> all{simulators::beam5x3(faults), simulators::beam5x3(),
                                       simulators::beam5x3()};
  for (auto& line : all[1].measured.value) line(1, 2) = line(3, 0) = line(4, 1) = {nan, nan};
  for (auto& line : all[2].measured.value) line.row(2).setConstant({nan, nan});
  return all;
}

TEST(MatrixFraction, DoesNotTakeGapsForZeros) {
  for (const auto& made : beams_with_gaps()) {
    if (made.measured.value[0].row(2).hasNaN()) continue;  // a sensor that was not measured
    const auto data = fit_data(made.measured);
    const auto fraction = matrix_fraction(data, {2, 2, 30, 0, {}});
    EXPECT_LT(fraction.cost, 1.3 * expected_cost(data, 0).mean);
  }
}

TEST(ThesisFit, FindsTheModesBesideGaps) {
  for (const auto& made : beams_with_gaps()) {
    const auto fit = thesis_fit(fit_data(made.measured), {.modes = 5, .levenberg_marquardt = 2});
    ASSERT_EQ(fit.model.mode_count(), 5);
    EXPECT_LT(std::abs(fit.excess()), 4.0);
    for (Eigen::Index m = 0; m < 5; ++m) {
      EXPECT_NEAR(fit.model.frequency_hz(m), made.truth.frequency_hz(m),
                  4.0 * fit.frequency_std_hz(m));
    }
  }
}

// A delay that was taken out before a fit is as uncertain as one that was fitted, and moves where
// the data tell another.
TEST(FreeDelay, HasTheDeviationOfTheBound) {
  for (const double late : {0.0, 2e-5}) {
    simulators::FrfFaults faults;
    faults.delay_s = late;
    const auto made = simulators::beam5x3(faults);
    const auto data = fit_data(made.measured);
    auto fit = thesis_fit(data, {.modes = 5, .levenberg_marquardt = 2});
    EXPECT_EQ(fit.delay_std_s, 0.0);
    FitOptions options;
    options.delay = true;
    free_delay(data, options, fit);
    const double bound = simulators::cramer_rao(made, {.delay = true}).delay_s;
    EXPECT_NEAR(fit.delay_std_s, bound, 0.1 * bound);
    EXPECT_NEAR(fit.delay_s, late, 5.0 * bound);
  }
}

// What is said of single modes holds for the fit that said it; what is said of the start stays.
TEST(FreeDelay, KeepsTheNotesOfTheStartAlone) {
  for (const double late : {0.0, 2e-5}) {  // the fit stays; it is replaced
    simulators::FrfFaults faults;
    faults.delay_s = late;
    const auto data = fit_data(simulators::beam5x3(faults).measured);
    auto fit = thesis_fit(data, {.modes = 5, .levenberg_marquardt = 2});
    fit.start_notes = {"of the start"};
    fit.notes = {"mode at 35.1 Hz: of this fit", "of the start"};
    const auto before = fit.notes;
    FitOptions options;
    options.delay = true;
    free_delay(data, options, fit);
    EXPECT_EQ(fit.notes, late > 0.0 ? fit.start_notes : before) << late;
    EXPECT_EQ(fit.start_notes, std::vector<std::string>{"of the start"});
  }
}

// Six modes of the wafer table, three at 0 Hz, seen at its four corners.
simulators::FrfCase six_modes() {
  const auto whole = simulators::oat4x13(noiseless());
  auto model = whole.truth;
  model.frequency_hz.conservativeResize(6);
  model.damping_ratio.conservativeResize(6);
  model.output_shapes.conservativeResize(Eigen::NoChange, 6);
  model.input_shapes = whole.truth.input_shapes.topLeftCorner(6, 5).eval();
  simulators::FrfGrid grid;
  grid.outputs = Eigen::MatrixX3d::Zero(4, 3);
  grid.inputs = Eigen::MatrixX3d::Ones(5, 3);
  grid.frequency_hz = Eigen::VectorXd::LinSpaced(500, 10.0, 500.0);
  return simulators::frf_case(model, grid, noiseless());
}

TEST(ThesisStart, NeedsAHigherDegreeWhereTheSensorsSeeTheModesInClasses) {
  const auto made = six_modes();
  const auto truth = true_poles(made.truth).tail(3).eval();
  const auto data = data_of(made);
  const auto least = thesis_start(data, {.modes = 3, .rigid_count = 3});
  EXPECT_GT(pole_error(least.pole, truth), 1e-4);
  const auto higher = thesis_start(data, {.modes = 3, .rigid_count = 3, .degree = 4});
  ASSERT_EQ(higher.pole.size(), 3);
  EXPECT_EQ(higher.rigid_count, 3);
  EXPECT_LT(pole_error(higher.pole, truth), 1e-6);
}

TEST(MatrixFraction, RefusesWhatTheDataCannotTell) {
  auto data = data_of(simulators::beam5x3());
  const auto few = [&](Eigen::Index lines) {
    FitData cut = data;
    cut.frequency_hz = data.frequency_hz.head(lines);
    cut.value = data.value.topRows(lines);
    cut.weight = data.weight.topRows(lines);
    return cut;
  };
  EXPECT_THROW((void)matrix_fraction(few(3), {}), InvalidInput);
  EXPECT_THROW((void)matrix_fraction(few(2), {2, 2, 5, 5, {}}), InvalidInput);
  EXPECT_THROW((void)matrix_fraction(data, {0, 0, 5, 5, {}}), InvalidInput);
  EXPECT_THROW((void)matrix_fraction(data, {200, 2, 5, 5, {}}), InvalidInput);
  EXPECT_THROW((void)thesis_start(data, {}), InvalidInput);
  data.weight.setZero();
  EXPECT_THROW((void)thesis_start(data, {.modes = 5}), InvalidInput);
}

TEST(ThesisStart, SaysHowFarItIs) {
  const auto data = data_of(simulators::beam5x3());
  std::vector<std::string> steps;
  double last = 0.0;
  const ThesisOptions options{.modes = 5,
                              .sanathanan_koerner = 4,
                              .levenberg_marquardt = 2,
                              .progress = [&](std::string_view step, double fraction) {
                                steps.emplace_back(step);
                                EXPECT_GE(fraction, 0.0);
                                EXPECT_LE(fraction, 1.0);
                                last = fraction;
                              }};
  (void)thesis_start(data, options);
  EXPECT_EQ(steps.size(), 6U);
  EXPECT_EQ(steps.front(), "Sanathanan-Koerner");
}

// An iteration that settles says nothing of last bits, whether noise or rounding is left.
TEST(MatrixFraction, IsAtRestWhereTheIterationSettles) {
  for (const auto& faults : {simulators::FrfFaults{}, noiseless()}) {
    const auto data = data_of(simulators::beam5x3(faults));
    EXPECT_LT(matrix_fraction(data, {2, 2, 30, 0, {}}).unrest, 2.0);
    EXPECT_TRUE(thesis_fit(data, {.modes = 5, .levenberg_marquardt = 2}).notes.empty());
  }
}

// An error that is not finite is the worst of all, whatever comparisons with it say.
TEST(MatrixFraction, IsNotAtRestWhereAnErrorIsNotFinite) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(unrest_of({9.0, 2.0, 2.0, 3.0}, 2.0), 1.5);
  EXPECT_EQ(unrest_of({}, 2.0), 1.0);
  for (const double last : {none, infinite}) {
    EXPECT_EQ(unrest_of({9.0, 2.0, 2.0, last}, 2.0), infinite);
    EXPECT_EQ(unrest_of({2.0, 2.0, last, 2.0}, 2.0), infinite);
  }
  EXPECT_EQ(unrest_note(infinite).find("inf "), std::string::npos);
  EXPECT_NE(unrest_note(infinite).find("not finite"), std::string::npos);
  EXPECT_NE(unrest_note(70.4).find("70 times the least, or what noise leaves"), std::string::npos);
}

// Vector fits that give values to gaps come before the first iteration: they are told, too.
TEST(MatrixFraction, SaysThatItSeeksPolesForGaps) {
  std::vector<std::string> steps;
  MatrixFractionOptions options{2, 2, 2, 0, {}};
  options.progress = [&](std::string_view step, double) { steps.emplace_back(step); };
  const auto gaps = beams_with_gaps();
  (void)matrix_fraction(fit_data(gaps.front().measured), options);
  ASSERT_FALSE(steps.empty());
  EXPECT_EQ(steps.front(), "finding poles");
  EXPECT_EQ(std::ranges::count(steps, "Sanathanan-Koerner"), 2);
  steps.clear();
  (void)matrix_fraction(fit_data(simulators::beam5x3().measured), options);
  EXPECT_EQ(steps.size(), 2U);
}

}  // namespace
}  // namespace chladni::identification
