// What is not solved again: modes of a body whose channels change, and changes of modes that no
// block asks for.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/loaded_plate.h"
#include "diagnosis/modes/cause_modes.h"
#include "diagnosis/modes/errors/mode_change.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kLowHz = 40.0;
constexpr double kHighHz = 3000.0;

const ModeSolver& plate_solver() {
  static const ModeSolver solver(state_of(small_plate()), small_plate().mode_count());
  return solver;
}

// The small plate with a mass, and with one effect of the catalogue at a usual size.
State with_a_mass() {
  State state = state_of(small_plate());
  effect("point_mass").apply(state, small_plate(), 0, Eigen::Vector3d(0.3, 0.21, 0.08));
  return state;
}
State with_a_mass_and(const Effect& other) {
  State state = with_a_mass();
  const auto parameters = other.parameters(small_plate());
  VectorXd x(static_cast<Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const bool is_place = parameters[i].is_place();
    x(static_cast<Index>(i)) = is_place ? small_plate().surface.places.mean()
                                        : parameters[i].centre + 0.3 * parameters[i].width;
  }
  other.apply(state, small_plate(), 0, x);
  return state;
}

TEST(KnownBody, IsThatOfEachEffectThatLeavesTheFrequencies) {
  const State loaded = with_a_mass();
  const auto body = plate_solver().body_modes(loaded, kLowHz, kHighHz);
  int of_channels = 0;
  for (const auto* other : effects()) {
    if (other->options(small_plate()) <= 0) continue;
    const State state = with_a_mass_and(*other);
    const auto modes = plate_solver().modes(state, kLowHz, kHighHz);
    const bool is_same = have_same_body(state, loaded);
    EXPECT_EQ(is_same, modes.frequency_hz.size() == body.frequency_hz.size() &&
                           modes.frequency_hz == body.frequency_hz &&
                           modes.damping_ratio == body.damping_ratio)
        << other->name;
    if (!is_same) continue;
    ++of_channels;
    const auto known = recorded(state, body);
    EXPECT_EQ(known.outputs, modes.outputs) << other->name;
    EXPECT_EQ(known.inputs, modes.inputs) << other->name;
    EXPECT_EQ(known.output_path, modes.output_path) << other->name;
    EXPECT_EQ(known.input_path, modes.input_path) << other->name;
  }
  EXPECT_GT(of_channels, 5);
}

TEST(CauseModes, AreTheSameBesideAKnownBody) {
  const auto measured = measured_of(modes_of(with_a_mass()), 0.01);
  const ModesProblem problem(small_plate(), measured, Tolerances{}, true);
  const std::vector<Supposed> causes{
      {&effect("sensor_gain"), 1, VectorXd::Constant(1, 0.2)},
      {&effect("point_mass"), 0, Eigen::Vector3d(0.3, 0.21, 0.08)},
      {&effect("sensor_position"), 2, Eigen::Vector2d(0.004, -0.002)}};
  CauseModes modes(problem);
  modes.begin_at(causes);
  Index c = 0;
  for (std::size_t which = 0; which < causes.size(); ++which) {
    for (Index i = 0; i < causes[which].x.size(); ++i, ++c) {
      auto moved = causes;
      moved[which].x(i) += 1e-3;
      const auto quick = modes.with_coordinate(moved, c);
      const auto whole = modes.of(moved);
      ASSERT_TRUE(quick && whole);
      EXPECT_EQ(quick->frequency_hz, whole->frequency_hz) << c;
      EXPECT_EQ(quick->damping_ratio, whole->damping_ratio) << c;
      EXPECT_EQ(quick->outputs, whole->outputs) << c;
      EXPECT_EQ(quick->inputs, whole->inputs) << c;
    }
  }
}

TEST(ModeChange, OfSomeModesIsThatOfAll) {
  const auto model = plate_solver().modes(with_a_mass(), kLowHz, kHighHz);
  std::vector<Index> all;
  for (Index k = 0; k < model.count(); ++k) all.push_back(k);
  const std::vector<Index> some{4, 1, 2};
  ASSERT_GT(model.count(), 5);
  ASSERT_FALSE(body().empty());
  for (const auto& error : body()) {
    const auto whole = change_by(error, model, all);
    const auto part = change_by(error, model, some);
    for (const Index k : all) {
      const bool is_asked = std::ranges::find(some, k) != some.end();
      const double by = is_asked ? 1.0 : 0.0;
      EXPECT_NEAR(part.frequency(k), by * whole.frequency(k), 1e-12);
      EXPECT_LT((part.outputs.col(k) - by * whole.outputs.col(k)).norm(),
                1e-10 * whole.outputs.norm());
      EXPECT_LT((part.inputs.col(k) - by * whole.inputs.col(k)).norm(),
                1e-10 * whole.inputs.norm());
    }
  }
}

}  // namespace
}  // namespace chladni::diagnosis
