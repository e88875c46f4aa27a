// Measured modes against a reference: what the model errs by in both is no cause.
#include "diagnosis/modes/reference/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "base/error.h"
#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/effect.h"
#include "diagnosis/modes/recorded_modes.h"
#include "diagnosis/wide_plate.h"
#include "host/parallel.h"
#include "rotation/turn.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using simulators::Dice;

constexpr Index kMeasured = 12;
constexpr double kPlateMass = 2700.0 * 0.6 * 0.47 * 0.02;

// The true plate: its frequencies and shapes are off by `error` and three times that, the same ones
// in each measurement, which has its own noise.
struct Rig {
  double error = 0.0;
  unsigned seed = 1;
};

MeasuredModes measured(const Rig& rig, const State& state, unsigned noise) {
  const ModeSolver solver(state_of(truth()), truth().mode_count());
  const RecordedModes exact = solver.modes(state, 60.0, 1e5);
  Dice wrong(rig.seed);
  Dice dice(1000 + noise);
  MeasuredModes all;
  all.outputs = truth().outputs.names;
  all.frequency_hz = exact.frequency_hz.head(kMeasured);
  all.damping_ratio = exact.damping_ratio.head(kMeasured);
  MatrixXd shapes = exact.outputs.leftCols(kMeasured);
  const Index p = shapes.rows();
  all.output_std.resize(p, kMeasured);
  for (Index k = 0; k < kMeasured; ++k) {
    const double scale = std::exp(rig.error * (1.0 + 0.2 * wrong.normal()));
    all.frequency_hz(k) *= scale * std::exp(2e-4 * dice.normal());
    all.damping_ratio(k) *= std::exp(4.0 * rig.error * wrong.normal() + 0.03 * dice.normal());
    // The sign of a shape is that of a weighted sum.
    const VectorXd weight = (2.3 * Eigen::ArrayXd::LinSpaced(p, 1.0, 13.0)).cos();
    if (weight.dot(shapes.col(k)) < 0.0) shapes.col(k) *= -1.0;
    const double size = shapes.col(k).norm() / std::sqrt(static_cast<double>(p));
    shapes.col(k) += 3.0 * rig.error * size * wrong.normal(p, 1);
    shapes.col(k) += 5e-3 * size * dice.normal(p, 1);
    all.output_std.col(k).setConstant(5e-3 * size);
  }
  all.frequency_std = VectorXd::Constant(kMeasured, 2e-4);
  all.damping_std = VectorXd::Constant(kMeasured, 0.03);
  all.output_shapes = exact.output_path.leftCols(kMeasured).cwiseProduct(shapes);
  all.input_shapes.resize(0, kMeasured);
  all.input_std.resize(0, kMeasured);
  return all;
}

State sound() { return state_of(truth()); }

State with_mass(double part, const Vector2d& place) {
  State state = sound();
  const Vector3d x(part * kPlateMass, place(0), place(1));
  effect("point_mass").apply(state, truth(), 0, x);
  return state;
}

MeasuredModes turned(MeasuredModes modes, unsigned seed) {
  Dice dice(seed);
  for (Index k = 0; k < modes.count(); ++k) {
    const auto factor = std::polar(std::exp(dice.normal()), dice.between(-3.0, 3.0));
    modes.output_shapes.col(k) *= factor;
    modes.output_std.col(k) *= std::abs(factor);
  }
  return modes;
}

std::string told(const Diagnosis& found) {
  std::string text(name(found.verdict));
  const auto add = [&](const Explanation& one) {
    text += "\n  " + std::to_string(one.probability) + " lnZ " + std::to_string(one.log_evidence);
    for (const auto& cause : one.causes) {
      text += "; " + cause.effect + " P " + std::to_string(cause.probability);
      for (const auto& channel : cause.channels) text += " " + channel;
      for (const auto& number : cause.parameters) {
        text += " " + number.name + "=" + std::to_string(number.value);
      }
    }
  };
  add(found.best);
  for (std::size_t i = 0; i < std::min<std::size_t>(3, found.rivals.size()); ++i) {
    add(found.rivals[i]);
  }
  for (const auto& level : found.levels_after) {
    text += "\n  level " + level.of + " " + std::to_string(level.value);
  }
  for (const auto& note : found.notes) text += "\n  " + note;
  return text;
}

DiagnosisOptions options() {
  DiagnosisOptions all;
  all.most_causes = 1;
  all.only = {"point_mass", "ground_spring", "youngs_modulus", "sensor_gain", "sensor_sign"};
  return all;
}

class ModesReference : public testing::Test {
 protected:
  void SetUp() override { set_thread_count(1); }
  void TearDown() override { set_thread_count(before_); }

 private:
  int before_ = thread_count();
};

TEST_F(ModesReference, FindsNothingWhereNothingChanged) {
  EVERY_FOURTH_LANDING();
  for (const double error : {0.0, 0.03, 0.05}) {
    const Rig rig{error, 7};
    const auto before = measured(rig, sound(), 1);
    EXPECT_EQ(diagnosed(study(), before, before, options()).verdict, Verdict::no_discrepancy);
    auto with = options();
    if (error == 0.05) with.only.clear();
    const auto found = diagnosed(study(), measured(rig, sound(), 2), before, with);
    EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << error << told(found);
    EXPECT_TRUE(found.notes.empty()) << told(found);
  }
}

TEST_F(ModesReference, FindsAMassWhateverTheModelsError) {
  EVERY_FOURTH_LANDING();
  const Vector2d place(0.21, 0.08);
  for (const double part : {2e-3, 1e-2}) {
    for (const double error : {0.0, 0.03, 0.05}) {
      const Rig rig{error, 11};
      const auto found = diagnosed(study(), measured(rig, with_mass(part, place), 3),
                                   measured(rig, sound(), 4), options());
      ASSERT_EQ(found.best.causes.size(), 1U) << part << error << told(found);
      const auto& cause = found.best.causes.front();
      EXPECT_EQ(cause.effect, "point_mass") << part << error << told(found);
      EXPECT_GT(cause.probability, 0.8) << part << error << told(found);
      ASSERT_TRUE(cause.place);
      EXPECT_LT((*cause.place - place).norm(), 0.03) << part << error << told(found);
    }
  }
}

TEST_F(ModesReference, TellsTheModesOfTheReference) {
  const Rig rig{0.03, 5};
  const auto before = measured(rig, sound(), 1);
  const auto after = measured(rig, with_mass(0.01, {0.21, 0.08}), 2);
  const auto found = diagnosed(study(), after, before, options());
  ASSERT_EQ(found.modes.size(), 12U);
  for (Index k = 0; k < 12; ++k) {
    const auto& mode = found.modes[static_cast<std::size_t>(k)];
    EXPECT_EQ(mode.reference_hz, before.frequency_hz(k));
    EXPECT_EQ(mode.measured_hz, after.frequency_hz(k));
    EXPECT_NEAR(mode.before_hz, before.frequency_hz(k), 1e-6 * mode.before_hz);
    EXPECT_NEAR(mode.after_hz, after.frequency_hz(k), 2e-3 * mode.after_hz);
  }
}

TEST_F(ModesReference, DoesNotMindTheFactorsOfShapes) {
  const Rig rig{0.03, 5};
  const auto before = measured(rig, sound(), 1);
  const auto after = measured(rig, with_mass(0.005, {-0.1, 0.15}), 2);
  const auto plain = diagnosed(study(), after, before, options());
  const auto other = diagnosed(study(), turned(after, 21), turned(before, 22), options());
  EXPECT_EQ(plain.verdict, other.verdict) << told(plain) << told(other);
  EXPECT_NEAR(plain.best.log_evidence, other.best.log_evidence, 1e-4);
}

TEST_F(ModesReference, FindsASensorThatWasTurned) {
  const Rig rig{0.03, 5};
  const auto before = measured(rig, sound(), 1);
  auto after = measured(rig, sound(), 2);
  after.output_shapes.row(4) *= -1.0;
  const auto found = diagnosed(study(), after, before, options());
  EXPECT_EQ(found.verdict, Verdict::named) << told(found);
  ASSERT_EQ(found.best.causes.size(), 1U) << told(found);
  EXPECT_EQ(found.best.causes.front().effect, "sensor_sign") << told(found);
  // One that was turned all the time has not changed.
  auto turned_before = before;
  turned_before.output_shapes.row(4) *= -1.0;
  EXPECT_EQ(diagnosed(study(), after, turned_before, options()).verdict, Verdict::no_discrepancy);
}

TEST_F(ModesReference, LeavesOutWhatOnlyOneHas) {
  const Rig rig{0.02, 5};
  const auto before = measured(rig, sound(), 1);
  auto after = measured(rig, sound(), 2);
  after.outputs[3] = "new";
  const auto both = common(after, before);
  EXPECT_EQ(both.later.outputs, both.reference.outputs);
  EXPECT_EQ(both.later.outputs.size(), 12U);
  EXPECT_EQ(both.notes.size(), 2U);
  for (auto& sensor : after.outputs) sensor = "x" + sensor;
  EXPECT_THROW(check_reference(after, before), InvalidInput);
}

TEST_F(ModesReference, RefusesModesThatAreOthers) {
  const Rig rig{0.0, 5};
  const auto before = measured(rig, sound(), 1);
  auto after = before;
  after.frequency_hz *= 3.0;
  after.frequency_hz.array() += before.frequency_hz.maxCoeff();
  EXPECT_THROW(check_reference(after, before), InvalidInput);
}

// The corrected structure has the frequencies of the reference, also where the model's are others.
TEST_F(ModesReference, CorrectsTheStructure) {
  const Rig rig{0.04, 9};
  const auto before = measured(rig, sound(), 1);
  const auto all = referred(study(), before, before, Tolerances{});
  const ModeSolver solver(state_of(all.structure), all.structure.mode_count());
  const auto modes = solver.modes(state_of(all.structure), 0.0, 1e5);
  for (const double hz : before.frequency_hz) {
    EXPECT_LT((modes.frequency_hz.array() - hz).abs().minCoeff(), 1e-6 * hz);
  }
}

}  // namespace
}  // namespace chladni::diagnosis
