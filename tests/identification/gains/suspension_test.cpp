#include "identification/suspension.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "gain_case.h"

namespace chladni::identification {
namespace {

using Modes = std::vector<Eigen::Index>;

Suspension found(const simulators::FrfCase& made, RigidMotion motion = RigidMotion::beam) {
  const auto geometry = geometry_of(made, motion);
  return suspension(true_fit(made), geometry.outputs, geometry.inputs);
}

TEST(Suspension, FindsTheTwoModesOfABeamOnItsFlexures) {
  const auto made = simulators::beam5x5(quiet());
  const auto told = found(made);
  EXPECT_EQ(told.modes, (Modes{0, 1}));
  const auto& frequency = made.truth.frequency_hz;
  EXPECT_GE(told.bending, std::pow(frequency(1) / frequency(2), 2));
  EXPECT_LT(told.bending, 0.1);
  // Two sensors lie on a straight line whatever they show: the actuators tell.
  EXPECT_EQ(found(two_by_four()).modes, (Modes{0, 1}));
  EXPECT_EQ(found(part(simulators::beam5x5(quiet()), {0, 2, 4}, {1})).modes, (Modes{0, 1}));
}

TEST(Suspension, FindsNothingWhereNothingTellsIt) {
  EXPECT_TRUE(found(part(simulators::beam5x5(quiet()), {0, 4}, {1, 2})).modes.empty());
  // Modes at 0 Hz are no suspended ones.
  EXPECT_TRUE(found(simulators::oat4x13(quiet()), RigidMotion::plate).modes.empty());
  // The lowest mode bends: a body whose suspension is below the band.
  auto made = simulators::beam5x5(quiet());
  auto fit = true_fit(made);
  fit.model.frequency_hz = fit.model.frequency_hz.tail(3).eval();
  fit.model.damping_ratio = fit.model.damping_ratio.tail(3).eval();
  fit.model.output_shapes = fit.model.output_shapes.rightCols(3).eval();
  fit.model.input_shapes = fit.model.input_shapes.bottomRows(3).eval();
  const auto geometry = geometry_of(made, RigidMotion::beam);
  EXPECT_TRUE(suspension(fit, geometry.outputs, geometry.inputs).modes.empty());
}

// A broken sensor and an actuator that was never driven have shapes of 0, which no rigid motion
// has. They are not known, so that all is as without them.
TEST(Suspension, LeavesOutChannelsThatWereNotMeasured) {
  const auto made = simulators::beam5x5(quiet());
  const auto geometry = geometry_of(made, RigidMotion::beam);
  auto fit = true_fit(made);
  fit.output_std = Eigen::MatrixXd::Constant(5, fit.model.mode_count(), 1e-6);
  fit.input_std = fit.output_std.transpose();
  fit.model.output_shapes.row(4).setZero();
  fit.output_std.row(4).setConstant(std::numeric_limits<double>::infinity());
  fit.model.input_shapes.col(0).setZero();
  fit.input_std.col(0).setConstant(std::numeric_limits<double>::infinity());
  const auto told = suspension(fit, geometry.outputs, geometry.inputs);
  EXPECT_EQ(told.modes, (Modes{0, 1}));
  const auto without = part(made, {0, 1, 2, 3}, {1, 2, 3, 4});
  const auto fewer = geometry_of(without, RigidMotion::beam);
  EXPECT_NEAR(told.bending, suspension(true_fit(without), fewer.outputs, fewer.inputs).bending,
              1e-12);
}

// A stiff suspension: what moves nearly as a whole lies right below what bends.
TEST(Suspension, IsWellBelowWhatBends) {
  const auto made = simulators::beam5x5(quiet());
  auto fit = true_fit(made);
  fit.model.frequency_hz(1) = 0.5 * fit.model.frequency_hz(2);
  const auto geometry = geometry_of(made, RigidMotion::beam);
  EXPECT_EQ(suspension(fit, geometry.outputs, geometry.inputs).modes, (Modes{0}));
}

TEST(Suspension, TakesWhatIsStated) {
  const auto made = part(simulators::beam5x5(quiet()), {0, 4}, {1, 2});
  const auto fit = true_fit(made);
  const auto geometry = geometry_of(made, RigidMotion::beam);
  const auto told = stated_suspension(fit, geometry.outputs, geometry.inputs, 2);
  EXPECT_EQ(told.modes, (Modes{0, 1}));
  EXPECT_GT(told.bending, 0.0);
  EXPECT_THROW((void)stated_suspension(fit, geometry.outputs, geometry.inputs, 3), InvalidInput);
}

// The bending that a suspended mode has is kept where a pair tells its scale.
TEST(Suspension, LetsPairsTellFirstWhereItIsToldTo) {
  const auto made = two_by_four();
  auto options = with_pairs(made);
  const auto plain = matched(made, true_fit(made), options);
  options.geometry = geometry_of(made, RigidMotion::beam);
  options.geometry->suspended = {0, 1};
  options.geometry->pairs_first = true;
  EXPECT_EQ(matched(made, true_fit(made), options).shapes, plain.shapes);
  options.pairs.clear();
  const auto alone = matched(made, true_fit(made), options);
  EXPECT_EQ(alone.modes[0].by, MatchedBy::geometry);
  EXPECT_EQ(alone.modes[1].by, MatchedBy::geometry);
  EXPECT_EQ(alone.modes[2].by, MatchedBy::nothing);
}

}  // namespace
}  // namespace chladni::identification
