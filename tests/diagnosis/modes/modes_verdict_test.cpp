#include "diagnosis/modes/modes_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/loaded_plate.h"
#include "diagnosis/modes/calibration/coordinates.h"
#include "diagnosis/modes/proposals/outlook.h"
#include "diagnosis/modes/significance.h"
#include "rotation/turn.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

TEST(PriorOfAPlace, IsAsWideAsTheSurfaceAlongEachAxis) {
  const Supposed mass{&effect("point_mass"), 0, Vector3d(0.1, 0.0, 0.0)};
  const auto prior = prior_of(small_plate(), {}, {mass});
  const auto parameters = mass.effect->parameters(small_plate());
  for (const Index i : {1, 2}) {
    const double precision = std::pow(prior_width(small_plate(), parameters[std::size_t(i)]), -2);
    EXPECT_NEAR(prior.precision(i), precision, 1e-9 * precision) << i;
  }
}

// A plate with a mass whose fourth mode has the shape of no other.
MeasuredModes with_a_strange_mode(double mass) {
  State state = state_of(small_plate());
  effect("point_mass").apply(state, small_plate(), 0, Vector3d(mass, 0.21, 0.08));
  auto measured = measured_of(modes_of(state), 0.02);
  simulators::Dice dice(9);
  const double size = measured.output_shapes.col(3).norm() /
                      std::sqrt(static_cast<double>(measured.output_shapes.rows()));
  const VectorXd strange = size * dice.normal(measured.output_shapes.rows(), 1);
  measured.output_shapes.col(3) = measured.output_shapes.col(3) + 1.2 * strange;
  return measured;
}

// One mode of a wrong shape is left without a partner, and hides nothing of the others.
TEST(ModesProblem, LeavesAModeAloneThatBelongsToNone) {
  const auto measured = with_a_strange_mode(1.2);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  ModesFit start;
  start.causes.push_back({&effect("point_mass"), 0, Vector3d(1.0, 0.2, 0.1)});
  const auto fit = problem.fitted(start);
  EXPECT_EQ(fit.matching.model[3], -1);
  for (std::size_t i = 0; i < fit.matching.model.size(); ++i) {
    if (i == 3) continue;
    EXPECT_GE(fit.matching.model[i], 0) << i;
  }
  ModesFit paired = fit;
  paired.matching = problem.matchings(fit.model).front();
  ASSERT_GE(paired.matching.model[3], 0);
  EXPECT_LT(problem.fitted(paired, 1).log_evidence, fit.log_evidence);
}

// The plate with a light thing that hangs on it and splits its sixth mode in two.
MeasuredModes with_a_split_mode(double& hz) {
  const auto& plate = small_plate();
  hz = 1.01 * modes_of(state_of(plate)).frequency_hz(5);
  VectorXd x(5);
  x << std::log(3e-4 * plate.mass_kg), std::log(hz), std::log(8e-3), 0.21, 0.08;
  State state = state_of(plate);
  effect("resonator").apply(state, plate, 0, x);
  return measured_of(modes_of(state), 0.02);
}

// Its own grid of frequencies is coarser than the split mode is wide.
TEST(Searched, FindsALightResonatorByTheModeThatItSplits) {
  EVERY_FOURTH_LANDING();
  double hz = 0.0;
  const auto measured = with_a_split_mode(hz);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  const auto found = searched(problem, catalogue_of(DiagnosisOptions{}), 1, 8.0);
  ASSERT_FALSE(found.fits.empty());
  const auto& cause = found.fits.front().causes.front();
  ASSERT_EQ(cause.effect->name, "resonator");
  EXPECT_NEAR(std::exp(cause.x(1)), hz, 0.02 * hz);
  EXPECT_NEAR(cause.x(0), std::log(3e-4 * small_plate().mass_kg), 1.0);
}

// A spring gives a rigid body a mode whose frequency goes with its root. Equal shapes are a pair up
// to e^+-0.25 in frequency: of starts farther from each other than 1 in ln k none may reach it.
TEST(GridOf, HasASpringNearEachStiffness) {
  const auto& spring = effect("ground_spring");
  const VectorXd hz = modes_of(state_of(small_plate())).frequency_hz.head(6);
  std::vector<double> sizes;
  for (const auto& start : grid_of(small_plate(), spring, hz, StartSizes::near)) {
    sizes.push_back(start.x(0));
  }
  std::ranges::sort(sizes);
  const auto parameter = spring.parameters(small_plate()).front();
  EXPECT_LT(sizes.front(), parameter.centre - parameter.width);
  EXPECT_GT(sizes.back(), parameter.centre + 3.0 * parameter.width);
  for (std::size_t i = 1; i < sizes.size(); ++i) EXPECT_LT(sizes[i] - sizes[i - 1], 1.0) << i;
}

// Where two modes turn into each other a step that lowers the misfit may raise the objective.
TEST(ModesProblem, ASecondFitLosesNothing) {
  double hz = 0.0;
  const auto measured = with_a_split_mode(hz);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  const auto fitted_from = [&](double part, double at_hz, double damping, double u, double v) {
    ModesFit start;
    VectorXd x(5);
    x << std::log(part * small_plate().mass_kg), std::log(at_hz), std::log(damping), u, v;
    start.causes.push_back({&effect("resonator"), 0, x});
    return problem.fitted(start);
  };
  const double truth = fitted_from(3e-4, hz, 8e-3, 0.21, 0.08).log_evidence;
  EXPECT_GT(truth, problem.nothing().log_evidence + 8.0);
  double best = -HUGE_VAL;
  for (const double off : {0.97, 0.99, 1.0, 1.01, 1.03}) {
    const auto first = fitted_from(1e-3, off * hz, 0.02, 0.18, 0.06);
    EXPECT_GT(problem.fitted(first).log_evidence, first.log_evidence - 0.3) << off;
    best = std::max(best, first.log_evidence);
  }
  EXPECT_GT(best, truth - 1.0);
}

// The covariance changes at once where a mode is split: steps that count the misfit alone creep
// there, and starts near the truth ended up to 19 below it.
TEST(ModesProblem, NearStartsEndAtOneMaximum) {
  EVERY_FOURTH_LANDING();
  double hz = 0.0;
  const auto measured = with_a_split_mode(hz);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  double least = HUGE_VAL;
  double most = -HUGE_VAL;
  for (const double part : {1e-4, 3e-4, 1e-3}) {
    for (const double off : {-0.02, 0.0, 0.02}) {
      ModesFit start;
      VectorXd x(5);
      x << std::log(part * small_plate().mass_kg), std::log(hz) + 0.3 * off, std::log(8e-3),
          0.21 + off, 0.08 - off;
      start.causes.push_back({&effect("resonator"), 0, x});
      const double found = problem.fitted(start).log_evidence;
      least = std::min(least, found);
      most = std::max(most, found);
    }
  }
  EXPECT_LT(most - least, 1.5);
}

// A pair is no better than its own parts allow: each cause of it stands by itself among the fits.
TEST(Searched, KeepsThePartsOfItsPairs) {
  EVERY_FOURTH_LANDING();
  State state = state_of(small_plate());
  effect("point_mass").apply(state, small_plate(), 0, Vector3d(0.6, 0.21, 0.08));
  effect("sensor_gain").apply(state, small_plate(), 2, VectorXd::Constant(1, 0.4));
  const auto measured = measured_of(modes_of(state), 0.02);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  DiagnosisOptions options;
  options.only = {"point_mass", "sensor_gain", "youngs_modulus"};
  const auto found = searched(problem, catalogue_of(options), 2, 8.0);
  const auto pair =
      std::ranges::find_if(found.fits, [](const ModesFit& fit) { return fit.causes.size() == 2; });
  ASSERT_NE(pair, found.fits.end());
  for (const auto& cause : pair->causes) {
    const bool is_alone = std::ranges::any_of(found.fits, [&](const ModesFit& fit) {
      return fit.causes.size() == 1 && alike(small_plate(), fit.causes.front(), cause);
    });
    EXPECT_TRUE(is_alone) << cause.effect->name;
  }
}

// What takes more stiffness than there is foretells nothing, and stops nothing.
TEST(Explained, LeavesOutWhatNoBodyIsLike) {
  const auto measured = measured_of(modes_of(state_of(small_plate())), 0.02);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, false);
  const auto nothing = problem.nothing();
  Effect impossible = effect("density");
  impossible.apply = [](State&, const Structure&, Index, const VectorXd&) {
    throw NumericalFailure("a place of the body loses more stiffness than it has");
  };
  ModesFit fit = nothing;
  fit.causes = {{&impossible, 0, VectorXd::Constant(1, 0.1)}};
  const auto question = question_of(problem, nothing);
  EXPECT_EQ(explained(question, {{&nothing, 0.5}, {&fit, 0.5}}).size(), 1U);
}

}  // namespace
}  // namespace chladni::diagnosis
