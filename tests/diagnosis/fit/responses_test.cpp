// Responses of a state against the inverse of its whole dynamic stiffness.
#include "diagnosis/fit/responses.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "diagnosis/attached/attachments.h"
#include "diagnosis/effect.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/small_plate.h"
#include "simulators/hidden/hidden_effect.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

MatrixXd definite(simulators::Dice& dice, Eigen::Index n) {
  const MatrixXd a = dice.normal(n, n);
  return a * a.transpose() / static_cast<double>(n);
}

// A state in which everything couples: fields, losses, attachments without upper modes.
State busy_state() {
  simulators::Dice dice(5);
  State state = state_of(small_plate());
  const Eigen::Index r = state.mode_count();
  const double scale = state.stiffness.diagonal().mean();
  state.stiffness += 0.02 * scale * definite(dice, r);
  state.mass += 0.05 * definite(dice, r);
  state.damping += 3.0 * definite(dice, r);
  state.loss += 1e-4 * scale * definite(dice, r);
  state.output_upper = MatrixXd::Zero(state.output_count(), 0);
  state.input_upper = MatrixXd::Zero(state.input_count(), 0);
  for (const bool carried : {false, true}) {
    Attached one;
    one.shapes = dice.normal(r, carried ? 1 : 2) * 0.2;
    one.mass = 0.3;
    one.damping = 4.0;
    one.stiffness = 2e5;
    one.carried = carried;
    state.attached.push_back(one);
  }
  return state;
}

MatrixXcd direct(const State& state, double omega) {
  const Complex s(0.0, omega);
  MatrixXcd z = state.stiffness.cast<Complex>() + Complex(0.0, 1.0) * state.loss.cast<Complex>() +
                s * state.damping.cast<Complex>() + s * s * state.mass.cast<Complex>();
  for (const auto& one : state.attached) {
    z += dynamic_stiffness(one, s) * (one.shapes * one.shapes.transpose()).cast<Complex>();
  }
  const MatrixXcd structure =
      state.outputs.cast<Complex>() * z.partialPivLu().solve(state.inputs.cast<Complex>()) +
      state.residual.cast<Complex>();
  return recorded(state, structure, s);
}

TEST(Responses, AreThoseOfTheWholeDynamicStiffness) {
  State state = busy_state();
  state.output_paths[1] = {.gain = -1.2, .delay = 3e-5, .lag = 1e-5, .derivative = 1.0};
  std::swap(state.input_of[0], state.input_of[4]);
  const auto omega = some_lines();
  const auto value = responses(state, omega);
  for (Eigen::Index k = 0; k < omega.size(); ++k) {
    const MatrixXcd expected = direct(state, omega(k));
    const MatrixXcd found = value.row(k).reshaped(expected.rows(), expected.cols());
    EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm()) << k;
  }
}

// A body of which more is taken away than is there, coupled and mode by mode, has no modes.
TEST(Responses, OfABodyWithoutAPositiveMassAreRefused) {
  const auto omega = some_lines();
  const Eigen::Index r = small_plate().mode_count();
  State coupled = state_of(small_plate());
  attach_mass(coupled, MatrixXd::Constant(r, r, -0.2));  // 1 - 0.2 r along one direction
  EXPECT_THROW(static_cast<void>(responses(coupled, omega)), NumericalFailure);
  State single = state_of(small_plate());
  single.mass(3, 3) = -0.5;
  EXPECT_THROW(static_cast<void>(responses(single, omega)), NumericalFailure);
  State none = state_of(small_plate());
  none.mass(3, 3) = 0.0;
  EXPECT_THROW(static_cast<void>(responses(none, omega)), NumericalFailure);
}

// Damping that couples two modes of one frequency does not let the iteration converge quickly.
TEST(Responses, AreRightWhereDampingCouplesRepeatedModes) {
  State state = state_of(small_plate());
  state.damping.setConstant(20.0);
  state.damping.diagonal().array() += 1.0;
  const auto omega = some_lines();
  const auto value = responses(state, omega);
  for (Eigen::Index k = 0; k < omega.size(); ++k) {
    const MatrixXcd expected = direct(state, omega(k));
    EXPECT_LT((value.row(k).reshaped(expected.rows(), expected.cols()) - expected).norm(),
              1e-6 * expected.norm());
  }
}

// A huge spring holds its place: what yields at once is in its way exactly.
TEST(Responses, OfABodyHeldBySpringsLetItsPlaceStandStill) {
  State state = state_of(small_plate());
  const auto motion = *small_plate().surface.at({0.07, -0.11});
  Attached spring;
  spring.shapes = motion.shape;
  spring.upper = motion.upper;
  spring.stiffness = 1e15;
  state.attached.push_back(spring);
  state.outputs.row(0) = motion.shape.transpose();
  state.output_upper.row(0) = motion.upper.transpose();
  state.residual.row(0) = (state.input_upper * motion.upper).transpose();
  const auto solution = solved(state, Body(state, some_lines()));
  const double others = solution.structure.cwiseAbs().maxCoeff();
  for (Eigen::Index j = 0; j < state.input_count(); ++j) {
    EXPECT_LT(solution.structure.col(state.output_count() * j).cwiseAbs().maxCoeff(),
              1e-6 * others);
  }
}

TEST(Responses, StayThoseOfTheBodyForStatesThatShareIt) {
  const State plain = state_of(small_plate());
  const Body body(plain, some_lines());
  State moved = plain;
  moved.outputs.row(2) *= 1.5;
  moved.inputs.col(3) *= 0.5;
  EXPECT_TRUE(body.same(moved));
  EXPECT_LT((solved(moved, body).value - responses(moved, some_lines())).norm(), 1e-18);
}

// A body that was stiffer while one input was used than while another was: column by column the
// whole dynamic stiffness of that time.
TEST(Responses, OfABodyThatDriftsAreEachOfItsOwnTime) {
  State state = busy_state();
  std::swap(state.input_of[0], state.input_of[4]);
  state.residual.setConstant(1e-9);
  state.stiffening = Eigen::VectorXd::LinSpaced(state.input_count(), -0.01, 0.02);
  const auto omega = some_lines();
  const auto value = responses(state, omega);
  const Eigen::Index p = state.output_count();
  for (Eigen::Index j = 0; j < state.input_count(); ++j) {
    State then = state;
    then.stiffening.resize(0);
    scale_stiffness(then, 1.0 + state.stiffening(j));
    for (Eigen::Index k = 0; k < omega.size(); ++k) {
      const Eigen::VectorXcd expected = direct(then, omega(k)).col(j);
      const Eigen::VectorXcd found = value.row(k).segment(p * j, p).transpose();
      EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm()) << j << " " << k;
    }
  }
}

// The slopes by a mass, a damping and a gain while the body drifts; and by the drift itself.
TEST(Responses, OfABodyThatDriftsHaveSlopesThatAreDifferences) {
  State state = busy_state();
  state.stiffening = Eigen::VectorXd::LinSpaced(state.input_count(), -0.01, 0.02);
  const auto omega = some_lines();
  const Solved now = solved(state, Body(state, omega));
  const std::vector<std::pair<double, std::function<void(State&, double)>>> changes = {
      {1e-5, [](State& one, double by) { one.attached[0].mass += by; }},
      {1e-3, [](State& one, double by) { one.damping(5, 5) += by; }},
      {1e-4, [](State& one, double by) { one.output_paths[1].gain += by; }},
      {1e-6, [](State& one, double by) { one.stiffening.array() += by; }}};
  for (const auto& [step, change] : changes) {
    State minus = state;
    State plus = state;
    change(minus, -step);
    change(plus, step);
    const MatrixXcd difference = (responses(plus, omega) - responses(minus, omega)) / (2.0 * step);
    EXPECT_LT((slope(state, now, minus, plus, 2.0 * step) - difference).norm(),
              1e-4 * difference.norm())
        << step;
  }
}

// The plate with its second sensor and its first actuator stated against the normal.
Structure plate_with_channels_against() {
  Structure turned = small_plate();
  const auto turn = [](ChannelSide& side, Eigen::Index i) {
    for (auto* rows : {&side.shapes, &side.slope_u, &side.slope_v, &side.upper}) {
      if (rows->size() > 0) rows->row(i) *= -1.0;
    }
  };
  turn(turned.outputs, 1);
  turn(turned.inputs, 0);
  turned.residual.row(1) *= -1.0;
  turned.residual.col(0) *= -1.0;
  return turned;
}

// @param against  of that plate
void expect_the_same_but_for_signs(const State& state, State against, std::string_view what) {
  against.output_paths[1].gain *= -1.0;
  against.input_paths[0].gain *= -1.0;
  const MatrixXcd expected = responses(state, some_lines());
  EXPECT_LT((responses(against, some_lines()) - expected).norm(), 1e-12 * expected.norm()) << what;
}

// Where directions are stated, shapes do not decide: those of a place of the scan that is not near.
TEST(PartsAlongNormal, AreThoseOfTheStatedDirections) {
  Structure plate = small_plate();
  auto& side = plate.outputs;
  side.directions = Eigen::RowVector3d::UnitZ().replicate(side.count(), 1);
  side.directions.row(1) *= -1.0;
  side.directions.row(2) << 0.8, 0.0, -0.6;
  side.directions.row(3) << 0.0, 0.96, -0.28;
  side.shapes.row(0) *= -1.0;
  side.shapes.row(3) *= -1.0;
  Eigen::VectorXd parts = Eigen::VectorXd::Ones(side.count());
  parts.segment(1, 3) << -1.0, -0.6, -0.28;
  EXPECT_EQ(parts_along_normal(plate, side), parts);
}

// A support that moves along the normal is nothing to a channel in the plane: neither as a cause
// nor as what is left open of the modes above.
TEST(Responses, OfChannelsInThePlaneHaveNothingOfASupportThatMovesAlongTheNormal) {
  Structure plate = small_plate();
  for (auto* side : {&plate.outputs, &plate.inputs}) {
    side->directions = Eigen::RowVector3d::UnitZ().replicate(side->count(), 1);
    side->directions.row(1) = Eigen::RowVector3d::UnitX();
  }
  const State before = state_of(plate);
  const auto moved = [&](const State& state) {
    const MatrixXcd change = responses(state, some_lines()) - responses(before, some_lines());
    return Eigen::MatrixXd(
        change.cwiseAbs().colwise().maxCoeff().reshaped(plate.output_count(), plate.input_count()));
  };
  const auto expect_nothing_in_the_plane = [&](const State& state) {
    const auto change = moved(state);
    EXPECT_EQ(change.row(1).maxCoeff(), 0.0);
    EXPECT_EQ(change.col(1).maxCoeff(), 0.0);
    EXPECT_GT(change(0, 0), 0.0);
  };
  State state = before;
  effect("frame").apply(
      state, plate, 0,
      Eigen::Vector3d(std::log(3.0 * plate.mass_kg), std::log(200.0), std::log(0.05)));
  expect_nothing_in_the_plane(state);
  for (const auto& one : deviations(plate, Tolerances{}, 1e9)) {
    if (one.name.find("share of the modes above") == std::string::npos) continue;
    state = before;
    one.apply(state, 0.7);
    expect_nothing_in_the_plane(state);
  }
}

TEST(Responses, OfChannelsAgainstTheNormalHaveTheSupportOfTheOthers) {
  const Structure turned = plate_with_channels_against();
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(turned.output_count());
  EXPECT_EQ(parts_along_normal(small_plate(), small_plate().outputs), signs);
  signs(1) = -1.0;
  EXPECT_EQ(parts_along_normal(turned, turned.outputs), signs);
  const Eigen::Vector3d x(std::log(3.0 * turned.mass_kg), std::log(200.0), std::log(0.05));
  State state = state_of(small_plate());
  State against = state_of(turned);
  effect("frame").apply(state, small_plate(), 0, x);
  effect("frame").apply(against, turned, 0, x);
  expect_the_same_but_for_signs(state, against, "frame");
  const auto own = deviations(small_plate(), Tolerances{}, 1e9);
  const auto others = deviations(turned, Tolerances{}, 1e9);
  for (std::size_t n = 0; n < own.size(); ++n) {
    if (own[n].name.find("of the modes above") == std::string::npos) continue;
    state = state_of(small_plate());
    against = state_of(turned);
    own[n].apply(state, 0.7);
    others[n].apply(against, 0.7);
    expect_the_same_but_for_signs(state, against, own[n].name);
  }
}

}  // namespace
}  // namespace chladni::diagnosis
