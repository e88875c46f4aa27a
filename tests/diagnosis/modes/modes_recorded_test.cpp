#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/effect.h"
#include "diagnosis/modes/recorded_modes.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kAnyHz = std::numeric_limits<double>::infinity();

State with(std::string_view name, Index option, const VectorXd& x) {
  State state = state_of(small_plate());
  effect(name).apply(state, small_plate(), option, x);
  return state;
}

RecordedModes modes_of(const State& state) {
  static const ModeSolver solver(state_of(small_plate()), small_plate().mode_count());
  return solver.modes(state, 0.0, kAnyHz);
}

// One mode of 100 Hz, damping ratio 1 %, at two sensors and one actuator.
State one_mode() {
  State state;
  const double omega = 200.0 * std::numbers::pi;
  state.stiffness = MatrixXd::Constant(1, 1, omega * omega);
  state.mass = MatrixXd::Ones(1, 1);
  state.damping = MatrixXd::Constant(1, 1, 0.02 * omega);
  state.loss = MatrixXd::Zero(1, 1);
  state.outputs = Eigen::Vector2d(0.5, -0.2);
  state.inputs = MatrixXd::Constant(1, 1, 0.3);
  state.residual = MatrixXd::Zero(2, 1);
  state.output_paths.resize(2);
  state.input_paths.resize(1);
  state.output_of = {0, 1};
  state.input_of = {0};
  return state;
}

Attached attachment(double shape) {
  Attached one;
  one.shapes = MatrixXd::Constant(1, 1, shape);
  return one;
}

// Shapes of modes that cannot be told apart may be turned: the sum of their products cannot.
MatrixXd products(const RecordedModes& modes, double hz) {
  MatrixXd all = MatrixXd::Zero(modes.outputs.rows(), modes.inputs.rows());
  for (Index k = 0; k < modes.count(); ++k) {
    if (std::abs(modes.frequency_hz(k) / hz - 1.0) > 1e-6) continue;
    all += modes.outputs.col(k) * modes.inputs.col(k).transpose();
  }
  return all;
}

TEST(ModeSolver, GivesTheModesOfTheStructure) {
  const auto& plate = small_plate();
  const RecordedModes modes = modes_of(state_of(plate));
  const Index n = plate.mode_count() - plate.rigid_count;
  ASSERT_EQ(modes.count(), n);
  EXPECT_TRUE(modes.frequency_hz.isApprox(plate.frequency_hz.tail(n), 1e-9));
  EXPECT_TRUE(modes.damping_ratio.isApprox(plate.damping_ratio.tail(n), 1e-9));
  EXPECT_TRUE((modes.output_path.array() == 1.0).all() && (modes.input_path.array() == 1.0).all());
  RecordedModes own;
  own.frequency_hz = plate.frequency_hz.tail(n);
  own.outputs = plate.outputs.shapes.rightCols(n);
  own.inputs = plate.inputs.shapes.rightCols(n);
  for (Index k = 0; k < n; ++k) {
    const MatrixXd expected = products(own, own.frequency_hz(k));
    const double unit = own.outputs.col(k).norm() * own.inputs.col(k).norm() + 1e-3;
    EXPECT_LT((products(modes, own.frequency_hz(k)) - expected).norm(), 1e-7 * unit) << k;
  }
  EXPECT_TRUE(modes.outputs.isApprox(plate.outputs.shapes * modes.motion, 1e-12));
}

TEST(ModeSolver, KeepsToTheBand) {
  const RecordedModes all = modes_of(state_of(small_plate()));
  const ModeSolver solver(state_of(small_plate()), small_plate().mode_count());
  const double low = 0.5 * (all.frequency_hz(1) + all.frequency_hz(2));
  const double high = all.frequency_hz(7) * (1.0 + 1e-9);
  const RecordedModes some = solver.modes(state_of(small_plate()), low, high);
  ASSERT_GE(some.count(), 6);
  EXPECT_EQ(some.frequency_hz(0), all.frequency_hz(2));
  EXPECT_LE(some.frequency_hz.maxCoeff(), high);
  EXPECT_EQ(some.outputs.col(0), all.outputs.col(2));
}

TEST(ModeSolver, ScalesFrequenciesWithTheRootOfTheModulus) {
  const RecordedModes before = modes_of(state_of(small_plate()));
  for (const double factor : {0.7, 1.12}) {
    const RecordedModes after =
        modes_of(with("youngs_modulus", 0, VectorXd::Constant(1, std::log(factor))));
    EXPECT_TRUE(after.frequency_hz.isApprox(std::sqrt(factor) * before.frequency_hz, 1e-9));
    const RecordedModes heavier =
        modes_of(with("density", 0, VectorXd::Constant(1, std::log(factor))));
    EXPECT_TRUE(heavier.frequency_hz.isApprox(before.frequency_hz / std::sqrt(factor), 1e-9));
  }
}

// Rayleigh: with a mass each frequency falls, but not below the one before it. With a spring each
// one rises, but not beyond the next.
TEST(ModeSolver, KeepsTheOrderThatRayleighFound) {
  const RecordedModes before = modes_of(state_of(small_plate()));
  const double last = before.frequency_hz(before.count() - 1);
  for (const double part : {1e-3, 0.05, 0.5}) {
    Eigen::Vector3d x(part * small_plate().mass_kg, 0.21, 0.13);
    const RecordedModes heavy = modes_of(with("point_mass", 0, x));
    ASSERT_GE(heavy.count(), before.count());
    for (Index k = 0; k < before.count(); ++k) {
      EXPECT_LE(heavy.frequency_hz(k), before.frequency_hz(k) * (1.0 + 1e-9)) << part << " " << k;
      if (k == 0) continue;
      EXPECT_GE(heavy.frequency_hz(k), before.frequency_hz(k - 1) * (1.0 - 1e-9)) << part;
    }
    EXPECT_LT(heavy.frequency_hz.head(6).sum(), before.frequency_hz.head(6).sum());
    x(0) = std::log(part * 1e8);
    const RecordedModes held = modes_of(with("ground_spring", 0, x));
    // One rigid-body motion becomes a mode.
    ASSERT_EQ(held.count(), before.count() + 1);
    for (Index k = 0; k < before.count(); ++k) {
      EXPECT_LE(held.frequency_hz(k), before.frequency_hz(k) * (1.0 + 1e-9)) << part << " " << k;
      EXPECT_GE(held.frequency_hz(k + 1), before.frequency_hz(k) * (1.0 - 1e-9)) << part;
    }
    EXPECT_GT(held.frequency_hz(before.count()), last);
  }
}

// What scales the body leaves the ratios that a study states: of two scales with the same
// frequencies damping is no judge.
TEST(ModeSolver, KeepsTheRatiosOfAScaledBody) {
  const auto before = modes_of(state_of(small_plate()));
  for (const char* kind : {"youngs_modulus", "density"}) {
    const auto after = modes_of(with(kind, 0, VectorXd::Constant(1, 0.2)));
    ASSERT_EQ(after.count(), before.count());
    EXPECT_TRUE(after.damping_ratio.isApprox(before.damping_ratio, 1e-9)) << kind;
  }
}

TEST(ModeSolver, IsExactForOneMode) {
  const ModeSolver solver(one_mode(), 1);
  for (const double shape : {0.0, 0.4, -2.0}) {
    const double square = shape * shape;
    State state = one_mode();
    state.attached = {attachment(shape)};
    auto& one = state.attached.front();
    one.mass = 0.7;
    one.stiffness = 2e4;
    one.damping = 1.3;
    const double mass = 1.0 + 0.7 * square;
    const double stiffness = state.stiffness(0, 0) + 2e4 * square;
    const double omega = std::sqrt(stiffness / mass);
    const RecordedModes modes = solver.modes(state, 0.0, kAnyHz);
    ASSERT_EQ(modes.count(), 1);
    EXPECT_NEAR(2.0 * std::numbers::pi * modes.frequency_hz(0), omega, 1e-9 * omega);
    // The body keeps its ratio, and the dashpot adds to it.
    const double own = state.damping(0, 0) * omega / std::sqrt(state.stiffness(0, 0));
    EXPECT_NEAR(modes.damping_ratio(0), (own + 1.3 * square) / (2.0 * omega * mass), 1e-12);
    EXPECT_NEAR(std::abs(modes.outputs(1, 0)), 0.2 / std::sqrt(mass), 1e-12);
  }
}

// The modes above lie in series with what is attached.
TEST(ModeSolver, LetsAnAttachmentYieldAsTheModesAboveDo) {
  const ModeSolver solver(one_mode(), 1);
  State state = one_mode();
  state.attached = {attachment(0.4)};
  state.attached.front().upper = MatrixXd::Constant(1, 1, 3e-3);
  state.attached.front().stiffness = 2e5;
  const double soft = 1.0 / (1.0 / 2e5 + 9e-6);
  EXPECT_NEAR(
      std::pow(2.0 * std::numbers::pi * solver.modes(state, 0.0, kAnyHz).frequency_hz(0), 2),
      state.stiffness(0, 0) + soft * 0.16, 1e-3);
  state.attached.front().stiffness = 0.0;
  state.attached.front().mass = 0.7;
  const RecordedModes modes = solver.modes(state, 0.0, kAnyHz);
  ASSERT_EQ(modes.count(), 2);
  for (const double hz : modes.frequency_hz) {  // −ω² + ω₀² = ω² φ² m / (1 − ω² m f)
    const double square = std::pow(2.0 * std::numbers::pi * hz, 2);
    const double carried = square * 0.16 * 0.7 / (1.0 - square * 0.7 * 9e-6);
    EXPECT_NEAR(state.stiffness(0, 0) - square, carried, 1e-6 * square);
  }
}

// Two modes of nearly one frequency repel: ω² ≈ ω₀² (1 ± φ √m).
TEST(ModeSolver, SplitsAModeAroundAResonator) {
  const ModeSolver solver(one_mode(), 1);
  State state = one_mode();
  Attached carried = attachment(0.4);
  carried.carried = true;
  carried.mass = 1e-3;
  carried.stiffness = carried.mass * state.stiffness(0, 0);
  state.attached = {carried};
  const RecordedModes modes = solver.modes(state, 0.0, kAnyHz);
  ASSERT_EQ(modes.count(), 2);
  const double by = 0.5 * 0.4 * std::sqrt(1e-3);
  EXPECT_NEAR(modes.frequency_hz(0), 100.0 * (1.0 - by), 100.0 * by * by);
  EXPECT_NEAR(modes.frequency_hz(1), 100.0 * (1.0 + by), 100.0 * by * by);
}

TEST(ModeSolver, AddsTheModeOfAResonator) {
  const RecordedModes before = modes_of(state_of(small_plate()));
  const double hz = 0.5 * (before.frequency_hz(0) + before.frequency_hz(1));
  VectorXd x(5);
  x << std::log(1e-4 * small_plate().mass_kg), std::log(hz), std::log(0.02), 0.21, 0.13;
  const RecordedModes after = modes_of(with("resonator", 0, x));
  ASSERT_EQ(after.count(), before.count() + 1);
  EXPECT_LT(after.frequency_hz(0), before.frequency_hz(0));
  EXPECT_NEAR(after.frequency_hz(1), hz, 1e-3 * hz);
  EXPECT_NEAR(after.damping_ratio(1), 0.02, 1e-3);
  EXPECT_GT(after.frequency_hz(2), before.frequency_hz(1));
}

// Each mode that the sensors see is where the responses of the same state have their peak.
TEST(ModeSolver, AgreesWithThePeaksOfTheResponses) {
  VectorXd x(5);
  x << std::log(0.01 * small_plate().mass_kg), std::log(250.0), std::log(2e-5), 0.21, 0.13;
  State state = with("resonator", 0, x);
  const auto add = [&](std::string_view name, const VectorXd& numbers) {
    effect(name).apply(state, small_plate(), 0, numbers);
  };
  add("point_mass", Eigen::Vector3d(0.4, -0.17, 0.08));
  add("ground_spring", Eigen::Vector3d(std::log(2e6), 0.11, -0.23));
  scale_damping(state, 0.01);
  const RecordedModes modes = modes_of(state);
  Index looked_at = 0;
  for (Index k = 0; k < 10; ++k) {
    const double hz = modes.frequency_hz(k);
    const double gap =
        std::min(k == 0 ? hz : hz - modes.frequency_hz(k - 1), modes.frequency_hz(k + 1) - hz);
    if (gap < 4e-3 * hz) continue;
    const VectorXd lines = VectorXd::LinSpaced(401, hz * (1.0 - 1e-3), hz * (1.0 + 1e-3));
    const VectorXd level = responses(state, 2.0 * std::numbers::pi * lines).rowwise().squaredNorm();
    Index peak = 0;
    level.maxCoeff(&peak);
    EXPECT_NEAR(lines(peak), hz, 5e-5 * hz) << k;
    ++looked_at;
  }
  EXPECT_GE(looked_at, 7);
}

// The residues that recorded modes state are those of the responses.
TEST(ModeSolver, AgreesWithTheSizeOfTheResponses) {
  State state = with("point_mass", 0, Eigen::Vector3d(0.4, -0.17, 0.08));
  effect("sensor_gain").apply(state, small_plate(), 2, VectorXd::Constant(1, 0.3));
  const RecordedModes modes = modes_of(state);
  const double omega = 2.0 * std::numbers::pi * modes.frequency_hz(0);
  const auto near = responses(state, VectorXd::Constant(1, omega));
  const Index p = state.output_count();
  const std::complex<double> at_peak(0.0, 2.0 * modes.damping_ratio(0) * omega * omega);
  Eigen::MatrixXcd own = (modes.output_path.col(0).cwiseProduct(modes.outputs.col(0)) *
                          modes.input_path.col(0).cwiseProduct(modes.inputs.col(0)).transpose()) /
                         at_peak;
  Eigen::MatrixXcd measured(p, state.input_count());
  for (Index c = 0; c < near.cols(); ++c) measured(c % p, c / p) = near(0, c);
  EXPECT_LT((own - measured).norm(), 0.05 * measured.norm());
}

TEST(ModeSolver, PutsTheFaultsOfChannelsInTheirPaths) {
  using Complex = std::complex<double>;
  const RecordedModes before = modes_of(state_of(small_plate()));
  const auto factor = [&](std::string_view name, const VectorXd& x, Index k) {
    const RecordedModes after = modes_of(with(name, 2, x));
    EXPECT_EQ(after.outputs, before.outputs) << name;
    EXPECT_EQ(after.inputs, before.inputs) << name;
    EXPECT_EQ(after.motion, before.motion) << name;
    EXPECT_EQ(after.frequency_hz, before.frequency_hz) << name;
    EXPECT_EQ(after.damping_ratio, before.damping_ratio) << name;
    EXPECT_EQ(after.input_path, before.input_path) << name;
    for (const Index other : {0, 1, 3}) {
      EXPECT_EQ(after.output_path.row(other), before.output_path.row(other)) << name;
    }
    return after.output_path(2, k);
  };
  for (const Index k : {0, 7}) {
    EXPECT_EQ(factor("sensor_sign", VectorXd(), k), Complex(-1.0));
    EXPECT_NEAR(std::abs(factor("sensor_gain", VectorXd::Constant(1, 0.3), k) - std::exp(0.3)), 0.0,
                1e-12);
    const double angle = -2.0 * std::numbers::pi * before.frequency_hz(k) * 2e-4;
    EXPECT_NEAR(
        std::abs(factor("sensor_delay", VectorXd::Constant(1, 2e-4), k) - std::polar(1.0, angle)),
        0.0, 1e-9);
  }
}

TEST(ModeSolver, SwapsRows) {
  const RecordedModes before = modes_of(state_of(small_plate()));
  const RecordedModes after = modes_of(with("swapped_sensors", 0, VectorXd()));
  EXPECT_EQ(after.outputs.row(0), before.outputs.row(1));
  EXPECT_EQ(after.outputs.row(1), before.outputs.row(0));
  EXPECT_EQ(after.outputs.bottomRows(2), before.outputs.bottomRows(2));
}

// The mode of a small mass on the modes above is far above all others. It hides none of them.
TEST(ModeSolver, ChangesNextToNothingForNextToNoMass) {
  const RecordedModes before = modes_of(state_of(small_plate()));
  for (double part = 1e-15; part < 2e-3; part *= 10.0) {
    const RecordedModes after =
        modes_of(with("point_mass", 0, Eigen::Vector3d(part * small_plate().mass_kg, 0.21, 0.13)));
    ASSERT_GE(after.count(), before.count()) << part;
    const VectorXd change = (after.frequency_hz.head(before.count()) - before.frequency_hz)
                                .cwiseQuotient(before.frequency_hz);
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 10.0 * part + 1e-9) << part;
  }
}

// A negative mass is impossible where the modes have less: 1 − m φᵀφ < 0.
TEST(ModeSolver, RefusesAMassThatIsNotPositive) {
  const auto& plate = small_plate();
  const double least = 1.0 / plate.surface.at({0.2, 0.1})->shape.squaredNorm();
  const auto less = [&](double part) {
    return modes_of(with("point_mass", 0, Eigen::Vector3d(-part * least, 0.2, 0.1)));
  };
  EXPECT_GT(less(0.9).frequency_hz.sum(), modes_of(state_of(plate)).frequency_hz.sum());
  for (const double part : {1.1, 3.0, 100.0}) EXPECT_THROW((void)less(part), NumericalFailure);
}

// The modes above are of the body: where no actuator or no sensor was measured, a patch and a pad
// yield as they do where both were.
TEST(ModeSolver, HasThePatchOfABodyWhateverChannelsWereMeasured) {
  const auto& plate = small_plate();
  const auto modes_with = [](const Structure& structure, std::string_view name) {
    State state = state_of(structure);
    const bool is_pad = name == "elastic_pad";
    const Eigen::Vector4d patch(std::log(0.3), 0.08, -0.05, std::log(0.04));
    const Eigen::Vector4d pad(std::log(4e5), std::log(0.04), 0.08, -0.05);
    effect(name).apply(state, structure, 0, is_pad ? pad : patch);
    return ModeSolver(state_of(structure), structure.mode_count()).modes(state, 0.0, kAnyHz);
  };
  auto not_pushed = plate;
  not_pushed.inputs = part_of(plate.inputs, {});
  not_pushed.residual.resize(plate.output_count(), 0);
  auto not_seen = plate;
  not_seen.outputs = part_of(plate.outputs, {});
  not_seen.residual.resize(0, plate.input_count());
  for (const auto* name : {"local_stiffness", "elastic_pad"}) {
    const VectorXd all = modes_with(plate, name).frequency_hz;
    const auto tolerance = 1e-9 * all.norm();
    for (const auto* structure : {&not_pushed, &not_seen}) {
      ASSERT_NO_THROW(check(*structure));
      EXPECT_LT((modes_with(*structure, name).frequency_hz - all).norm(), tolerance) << name;
    }
    EXPECT_GT((modes_of(state_of(plate)).frequency_hz - all).norm(), 1e3 * tolerance) << name;
  }
}

}  // namespace
}  // namespace chladni::diagnosis
