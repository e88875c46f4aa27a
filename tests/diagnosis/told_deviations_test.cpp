#include "diagnosis/verdict/told_deviations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "base/index.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/small_plate.h"
#include "diagnosis/verdict/cause_of.h"
#include "rotation/turn.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Channels on the axis v = 0 of the plate: modes that are odd in v do not move there.
ChannelSide on_axis(const Structure& plate, std::initializer_list<double> places) {
  ChannelSide side;
  const auto count = static_cast<Index>(places.size());
  for (auto* matrix : {&side.shapes, &side.slope_u, &side.slope_v, &side.aside_u, &side.aside_v}) {
    *matrix = MatrixXd::Zero(count, plate.mode_count());
  }
  side.places = Eigen::MatrixX2d::Zero(count, 2);
  side.upper = MatrixXd(count, 0);
  Index row = 0;
  for (const double u : places) {
    const auto motion = *plate.surface.at({u, 0.0});
    side.names.push_back("c" + std::to_string(row));
    side.shapes.row(row) = motion.shape;
    side.slope_u.row(row) = motion.slope_u;
    side.slope_v.row(row) = motion.slope_v;
    side.places(row++, 0) = u;
  }
  return side;
}

Structure plate_seen_on_its_axis() {
  Structure plate = small_plate();
  plate.outputs = on_axis(plate, {-0.25, -0.1, 0.05, 0.22});
  plate.inputs = on_axis(plate, {-0.27, 0.12});
  plate.residual = MatrixXd::Zero(4, 2);
  return plate;
}

Fit fit_of(const Problem& problem, const Supposed& cause) {
  Fit start;
  start.causes = {cause};
  start.eta = VectorXd(0);
  return fitted(problem, start);
}

TEST(ToldDeviations, AreThoseOfTheCovarianceWhereTheMisfitIsASquare) {
  const auto& plate = small_plate();
  const std::vector<Deviation> none;
  const Supposed gain{&effect("sensor_gain"), 2, VectorXd::Constant(1, std::log(1.02))};
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)};
  for (const auto& cause : {gain, mass}) {
    const Observed seen =
        with_noise(observed_in(state_of({plate, {}, none}, {cause}, VectorXd(0)), 100.0), 5);
    const Problem problem{plate, seen, none};
    const VectorXd longer = longer_deviations(problem, fit_of(problem, cause));
    EXPECT_GE(longer.minCoeff(), 1.0);
    EXPECT_LT(longer.maxCoeff(), 1.1) << longer.transpose();
  }
}

// The responses on the axis hold the square of the distance of a mass from it. The curvature at the
// fit tells how well the square is known, so where noise moves the fit off the axis, the axis is
// many such deviations away.
TEST(ToldDeviations, HoldAMassOnAnAxisThatAllChannelsStandOn) {
  EVERY_FOURTH_LANDING();
  const Structure plate = plate_seen_on_its_axis();
  const std::vector<Deviation> none;
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.08, 0.08, 0.0)};
  const State state = state_of({plate, {}, none}, {mass}, VectorXd(0));
  constexpr int kDraws = 60;
  int beyond = 0;
  int beyond_by_curvature = 0;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const Observed seen = with_noise(observed_in(state, 100.0), seed);
    const Problem problem{plate, seen, none};
    const Fit fit = fit_of(problem, {mass.effect, 0, Eigen::Vector3d(0.08, 0.08, 0.01)});
    const double curvature = std::sqrt(fit.covariance(2, 2));
    const double off = std::abs(fit.causes.front().x(2));
    beyond_by_curvature += off > 2.0 * curvature ? 1 : 0;
    beyond += off > 2.0 * curvature * longer_deviations(problem, fit)(2) ? 1 : 0;
  }
  EXPECT_GT(beyond_by_curvature, kDraws / 10);
  EXPECT_LE(beyond, kDraws / 20 + 2);
}

// The plate with other shapes beneath what is attached to it, each mode by a factor of its own.
Structure with_other_shapes(const Structure& plate, double error, unsigned seed) {
  simulators::Dice dice(seed);
  const VectorXd factor = 1.0 + error * dice.normal(plate.mode_count(), 1).array();
  Structure other = plate;
  other.surface.at = [at = plate.surface.at,
                      factor](const Eigen::Vector2d& place) -> std::optional<PointMotion> {
    auto motion = at(place);
    if (!motion) return motion;
    for (auto* shape : {&motion->shape, &motion->slope_u, &motion->slope_v}) {
      *shape = shape->cwiseProduct(factor);
    }
    return motion;
  };
  return other;
}

Explanation told_of(const Problem& problem, const Fit& fit) {
  Explanation told;
  told.causes = {cause_of(problem.structure, fit.causes.front(), fit.covariance.diagonal())};
  widen_deviations(problem, fit, told);
  return told;
}

// Shapes of another solver are off by half of what their squares are.
TEST(ToldDeviations, HoldPlacesBySolversWhoseShapesDiffer) {
  const auto& plate = small_plate();
  const std::vector<Deviation> none;
  constexpr double kError = 0.02;
  constexpr int kDraws = 20;
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.3, 0.1, -0.05)};
  double by_noise = 0.0;
  double told = 0.0;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const Structure truth = with_other_shapes(plate, 0.5 * kError, seed);
    const Observed seen = with_noise(
        observed_in(state_of({truth, {}, none}, {mass}, VectorXd(0)), 1000.0), 100 + seed);
    const Problem problem{plate, seen, none, kError};
    const Fit fit = fit_of(problem, mass);
    const auto causes = told_of(problem, fit).causes;
    for (const Index n : {1, 2}) {
      const double off = fit.causes.front().x(n) - mass.x(n);
      by_noise += off * off / fit.covariance(n, n);
      told += std::pow(off / causes.front().parameters[at(n)].std, 2);
    }
  }
  EXPECT_GT(by_noise / (2 * kDraws), 16.0);
  EXPECT_LT(told / (2 * kDraws), 1.5);
  EXPECT_GT(told / (2 * kDraws), 0.02);
}

// A resonance on a mode stands beside its pole by a part of the frequency that the coupling tells.
TEST(ToldDeviations, OfAResonanceHoldTheErrorOfItsDistanceFromThePole) {
  const auto& plate = small_plate();
  const std::vector<Deviation> none;
  const Supposed resonator{
      &effect("resonator"), 0,
      (VectorXd(5) << std::log(0.2), std::log(400.0), std::log(0.02), 0.1, -0.05).finished()};
  const Observed seen = observed_in(state_of({plate, {}, none}, {resonator}, VectorXd(0)), 100.0);
  const Problem exact{plate, seen, none};
  const Problem solved{plate, seen, none, 0.03};
  const Fit fit = fit_of(exact, resonator);
  const auto without = told_of(exact, fit).causes.front().parameters[1];
  const auto with = told_of(solved, fit).causes.front().parameters[1];
  ASSERT_EQ(with.name, "frequency");
  const Index seen_modes = (plate.frequency_hz.array() <= 893.0).count();
  const double most = plate.surface.at({0.1, -0.05})->shape.head(seen_modes).cwiseAbs().maxCoeff();
  const double added = 0.03 * 0.25 * std::sqrt(0.2) * most * 400.0;
  EXPECT_NEAR(with.std, std::hypot(without.std, added), 1e-3 * added);
}

}  // namespace
}  // namespace chladni::diagnosis
