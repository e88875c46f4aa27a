#include "simulators/plates/ritz_response.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"

namespace chladni::simulators {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

const RitzModes& table() {
  static const RitzModes modes = ritz_modes(aluminium_table(8));
  return modes;
}

RitzStage stage() { return {table(), modal_damping(table(), 5e-3), {}, {}, {}, {}}; }

RitzGrid grid() {
  RitzGrid seen;
  seen.outputs.resize(3, 2);
  seen.outputs << -0.25, 0.25, 0.25, 0.1, 0.0, -0.2;
  seen.inputs.resize(3, 2);
  seen.inputs << -0.25, 0.25, 0.25, 0.1, 0.13, 0.07;
  seen.frequency_hz = Eigen::VectorXd::LinSpaced(25, 20.0, 900.0);
  return seen;
}

double difference(const std::vector<Eigen::MatrixXcd>& a, const std::vector<Eigen::MatrixXcd>& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    worst = std::max(worst, (a[k] - b[k]).norm() / b[k].norm());
  return worst;
}

RitzStage everything() {
  auto all = stage();
  all.points = {{{0.1, 0.05}, 0.4, 1e-3, 0.0, 30.0}, {{-0.2, 0.11}, 0.0, 0.0, 2e5, 0.0}};
  all.resonators = {{{0.22, -0.13}, 0.3, 310.0, 0.02}};
  all.pads = {{{-0.15, -0.2}, 0.08, 4e5}};
  all.frame = RitzFrame{60.0, 90.0, 0.03};
  return all;
}

TEST(RitzResponse, IsTheInverseOfTheWholeDynamicStiffness) {
  EXPECT_LT(difference(ritz_receptance(stage(), grid()), direct_receptance(stage(), grid())), 1e-9);
  auto one = grid();
  one.frequency_hz = Eigen::Vector4d(35.0, 180.0, 311.0, 880.0);
  EXPECT_LT(difference(ritz_receptance(everything(), one), direct_receptance(everything(), one)),
            2e-5);
}

// A fixture of the body has the same effect as an attached point.
TEST(RitzResponse, AFixtureIsAPointThatWasThereBefore) {
  auto hung = stage();
  hung.points = {{{0.1, 0.05}, 0.4, 1e-3, 0.0, 0.0}};
  RitzFixture one;
  one.place = {0.1, 0.05};
  one.mass = 0.4;
  one.inertia_x = one.inertia_y = 1e-3;
  auto body = aluminium_table(8);
  body.fixtures = {one};
  const Eigen::VectorXd fixed = ritz_modes(body).frequency_hz;
  const Eigen::VectorXd other = stage_frequencies_hz(hung);
  EXPECT_LT((fixed - other).segment(3, 40).norm(), 1e-7 * other.segment(3, 40).norm());
}

// Below all flexible modes the plate is a rigid body. A push at x lifts and turns the plate. A
// sensor of height z with a tilt toward x sees less motion, by tilt times z times the turn.
TEST(RitzResponse, ATiltedChannelSeesTheMotionAlongThePlate) {
  auto one = grid();
  one.outputs = Eigen::RowVector2d(0.2, 0.0);
  one.inputs = Eigen::RowVector2d(0.25, 0.0);
  one.frequency_hz = Eigen::VectorXd::Constant(1, 0.05);
  one.output_tilts = Eigen::RowVector2d(0.3, 0.0);
  one.input_tilts = Eigen::RowVector2d(0.0, 0.0);
  one.output_height = 0.01;
  const double m = 19.44;
  const double turning = m * (0.36 + 4e-4) / 12.0;
  const double omega2 = std::pow(2.0 * pi * 0.05, 2);
  const double lift = 1.0 / m + 0.2 * 0.25 / turning;
  const double expected = -(lift - 0.3 * 0.01 * 0.25 / turning) / std::sqrt(1.09) / omega2;
  EXPECT_NEAR(ritz_receptance(stage(), one)[0](0, 0).real(), expected, 1e-4 * std::abs(expected));
  std::swap(one.outputs, one.inputs);
  std::swap(one.output_tilts, one.input_tilts);
  std::swap(one.output_height, one.input_height);
  EXPECT_NEAR(ritz_receptance(stage(), one)[0](0, 0).real(), expected, 1e-4 * std::abs(expected));
}

TEST(RitzResponse, IsReciprocal) {
  for (const auto& g : ritz_receptance(everything(), grid())) {
    EXPECT_NEAR(std::abs(g(0, 1) - g(1, 0)), 0.0, 1e-9 * std::abs(g(0, 1)));
  }
}

// Newton: far below the first mode the plate is a rigid body of 19.44 kg with its inertia.
TEST(RitzResponse, IsARigidBodyFarBelowItsModes) {
  auto low = grid();
  low.frequency_hz = Eigen::VectorXd::Constant(1, 0.01);
  const double inertia = 19.44 * (0.36 + 0.0004) / 12.0;
  const double factor = -4.0 * pi * pi * 1e-4;
  const auto with_mass = [&](double kg) {
    auto loaded = stage();
    if (kg > 0.0) loaded.points = {{{0.0, 0.0}, kg, 0.0, 0.0, 0.0}};
    return ritz_receptance(loaded, low).front();
  };
  for (const double kg : {0.0, 2.0}) {
    const double expected = (1.0 / (19.44 + kg) + (0.25 * 0.13 + 0.1 * 0.07) / inertia) / factor;
    EXPECT_NEAR(with_mass(kg)(1, 2).real(), expected, 1e-6 * std::abs(expected)) << kg;
  }
}

TEST(RitzResponse, HangsInItsSprings) {
  auto hung = stage();
  hung.points = {{{0.0, 0.0}, 0.0, 0.0, 4e3, 0.0}};
  EXPECT_NEAR(stage_frequencies_hz(hung)(2), std::sqrt(4e3 / 19.44) / (2.0 * pi), 2e-3);
  auto bedded = stage();
  bedded.pads = {{{0.0, 0.0}, 1.0, 4e5}};  // the whole plate: heave at √(k/m), as one
  const Eigen::VectorXd hz = stage_frequencies_hz(bedded);
  double nearest = 1e9;
  for (const double f : hz.head(6))
    nearest = std::min(nearest, std::abs(f - std::sqrt(4e5 / 19.44) / (2.0 * pi)));
  EXPECT_LT(nearest, 1e-4);
}

// A rotary inertia that follows the slopes adds to the inertia of the plate.
TEST(RitzResponse, TurnsSlowerWithARotaryInertia) {
  auto low = grid();
  low.frequency_hz = Eigen::VectorXd::Constant(1, 0.01);
  auto loaded = stage();
  loaded.points = {{{0.0, 0.0}, 0.0, 0.2, 0.0, 0.0}};
  const double inertia = 19.44 * (0.36 + 0.0004) / 12.0 + 0.2;
  const double expected =
      (1.0 / 19.44 + (0.25 * 0.13 + 0.1 * 0.07) / inertia) / (-4.0 * pi * pi * 1e-4);
  EXPECT_NEAR(ritz_receptance(loaded, low).front()(1, 2).real(), expected,
              1e-6 * std::abs(expected));
}

TEST(RitzResponse, StiffResonatorsAreMassesAndSoftOnesNothing) {
  auto mass = stage();
  mass.points = {{{0.22, -0.13}, 0.3, 0.0, 0.0, 0.0}};
  auto stiff = stage();
  stiff.resonators = {{{0.22, -0.13}, 0.3, 2e5, 0.0}};
  EXPECT_LT(difference(ritz_receptance(stiff, grid()), ritz_receptance(mass, grid())), 1e-4);
  auto soft = stage();
  soft.resonators = {{{0.22, -0.13}, 0.3, 0.05, 0.0}};
  EXPECT_LT(difference(ritz_receptance(soft, grid()), ritz_receptance(stage(), grid())), 1e-4);
}

TEST(RitzResponse, StandsStillUnderAResonatorAtItsFrequency) {
  auto tuned = stage();
  tuned.resonators = {{{0.25, 0.1}, 0.3, 310.0, 0.0}};
  auto line = grid();
  line.frequency_hz = Eigen::VectorXd::Constant(1, 310.0);
  const Eigen::MatrixXcd still = ritz_receptance(tuned, line).front();
  const Eigen::MatrixXcd before = ritz_receptance(stage(), line).front();
  EXPECT_LT(still.row(1).norm(), 1e-5 * before.row(1).norm());
}

// Sensors on the frame see its motion with the opposite sign; the plate does not move with it.
TEST(RitzResponse, AddsTheFrameAlikeToAll) {
  auto carried = stage();
  carried.frame = RitzFrame{60.0, 90.0, 0.03};
  const auto with = ritz_receptance(carried, grid());
  const auto without = ritz_receptance(stage(), grid());
  for (Eigen::Index k = 0; k < grid().frequency_hz.size(); ++k) {
    const Complex s(0.0, 2.0 * pi * grid().frequency_hz(k));
    const double omega = 2.0 * pi * 90.0;
    const Complex moves = 1.0 / (60.0 * (s * s + 0.06 * omega * s + omega * omega));
    const auto i = static_cast<std::size_t>(k);
    const Eigen::MatrixXcd expected = (without[i].array() + moves).matrix();
    EXPECT_LT((with[i] - expected).norm(), 1e-6 * expected.norm()) << k;
  }
}

// A very large dashpot holds its place still. A small dashpot dissipates v² c.
TEST(RitzResponse, DashpotsHoldAndDissipate) {
  auto held = stage();
  held.points = {{{0.25, 0.1}, 0.0, 0.0, 0.0, 1e12}};
  const auto g = ritz_receptance(held, grid());
  const auto bare = ritz_receptance(stage(), grid());
  for (std::size_t k = 0; k < g.size(); ++k)
    EXPECT_LT(g[k].row(1).norm(), 1e-5 * bare[k].row(1).norm());
  auto small = stage();
  small.damping.viscous.setZero();
  small.points = {{{0.25, 0.1}, 0.0, 0.0, 0.0, 12.0}};
  auto line = grid();
  line.frequency_hz = Eigen::VectorXd::Constant(1, 240.0);
  const Eigen::MatrixXcd moves = ritz_receptance(small, line).front();
  const double omega = 2.0 * pi * 240.0;
  const double power_in = -0.5 * omega * moves(0, 0).imag();  // ½ Re(f* jω w), unit force
  const double power_out = 0.5 * 12.0 * omega * omega * std::norm(moves(1, 0));
  EXPECT_NEAR(power_in, power_out, 1e-6 * power_out);
}

TEST(RitzResponse, HystereticAndViscousAgreeAtResonance) {
  auto one = grid();
  one.frequency_hz = table().frequency_hz.segment(3, 1);
  auto lossy = stage();
  lossy.damping = hysteretic_damping(table(), 5e-3);
  const auto viscous = ritz_receptance(stage(), one);
  EXPECT_LT(difference(ritz_receptance(lossy, one), viscous), 1e-4);
  one.frequency_hz *= 0.8;
  EXPECT_GT(difference(ritz_receptance(lossy, one), viscous), 1e-4);
}

TEST(RitzResponse, CarriesDampingFromPlateToPlate) {
  const auto damping = modal_damping(table(), 5e-3, 1.0, 180.0);
  const auto same = carried_over(damping, table(), table());
  EXPECT_LT((same.viscous - damping.viscous).norm(), 1e-8 * damping.viscous.norm());
  auto stiffer = aluminium_table(8);
  stiffer.stiffness.q11 *= 1.1;
  const auto modes = ritz_modes(stiffer);
  const auto kept = carried_over(damping, table(), modes);
  EXPECT_LT((kept.viscous - kept.viscous.transpose()).norm(), 1e-8 * kept.viscous.norm());
  // The same motion loses the same energy in both coordinates.
  const Eigen::VectorXd motion = Eigen::VectorXd::LinSpaced(modes.mode_count(), -1.0, 1.0);
  const Eigen::VectorXd here = modes.coefficients.partialPivLu().solve(motion);
  const Eigen::VectorXd there = table().coefficients.partialPivLu().solve(motion);
  EXPECT_NEAR(here.dot(kept.viscous * here), there.dot(damping.viscous * there),
              1e-8 * there.dot(damping.viscous * there));
}

// K scales as 1/l² and M as l². A plate that is larger by one factor in length and width has the
// same damping ratio.
TEST(RitzResponse, StretchesDampingWithThePlate) {
  auto larger = aluminium_table(8);
  larger.length *= 1.01;
  larger.width *= 1.01;
  const auto modes = ritz_modes(larger);
  for (const double exponent : {0.0, 1.0}) {
    const auto damping = modal_damping(table(), 5e-3, exponent, 180.0);
    const auto kept = carried_over(damping, table(), modes);
    for (Eigen::Index k = 3; k < 13; ++k) {
      const double before = damping.viscous(k, k) / table().frequency_hz(k);
      EXPECT_NEAR(kept.viscous(k, k) / modes.frequency_hz(k), before, 2e-3 * before) << k;
    }
  }
  larger.width *= 1.01;
  EXPECT_THROW((void)carried_over(modal_damping(table(), 5e-3), table(), ritz_modes(larger)),
               InvalidInput);
}

TEST(RitzResponse, SaysWhatIsWrong) {
  auto bad = stage();
  bad.points = {{{0.0, 0.0}, -1.0, 0.0, 0.0, 0.0}};
  EXPECT_THROW((void)ritz_receptance(bad, grid()), InvalidInput);
  auto none = grid();
  none.frequency_hz(0) = 0.0;
  EXPECT_THROW((void)ritz_receptance(stage(), none), InvalidInput);
}

}  // namespace
}  // namespace chladni::simulators
