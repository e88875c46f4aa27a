#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/index.h"
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

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kFrequencyError = 0.015, kShapeError = 0.05;

struct Hidden {
  std::string_view effect;
  Index option = 0;
  VectorXd x;
};

// The first modes of the true plate, each number with an error of the model.
MeasuredModes measured_with(const std::vector<Hidden>& hidden, unsigned seed, Index modes = 12) {
  State state = state_of(truth());
  for (const auto& one : hidden) effect(one.effect).apply(state, truth(), one.option, one.x);
  const ModeSolver solver(state_of(truth()), truth().mode_count());
  const RecordedModes exact = solver.modes(state, 60.0, 1e5);
  Dice dice(seed);
  MeasuredModes measured;
  measured.outputs = truth().outputs.names;
  measured.frequency_hz = exact.frequency_hz.head(modes);
  for (double& hz : measured.frequency_hz) hz *= std::exp(kFrequencyError * dice.normal());
  std::sort(measured.frequency_hz.begin(), measured.frequency_hz.end());
  measured.frequency_std = VectorXd::Constant(modes, 1e-4);
  measured.damping_ratio = exact.damping_ratio.head(modes);
  for (double& ratio : measured.damping_ratio) ratio *= std::exp(0.2 * dice.normal());
  measured.damping_std = VectorXd::Constant(modes, 0.02);
  MatrixXd shapes = exact.outputs.leftCols(modes);
  const Index p = shapes.rows();
  measured.output_std.resize(p, modes);
  for (Index k = 0; k < modes; ++k) {
    const double size = shapes.col(k).norm() / std::sqrt(static_cast<double>(p));
    shapes.col(k) += kShapeError * size * dice.normal(p, 1);
    measured.output_std.col(k).setConstant(5e-3 * size);
  }
  measured.output_shapes = exact.output_path.leftCols(modes).cwiseProduct(shapes);
  measured.input_shapes.resize(0, modes);
  measured.input_std.resize(0, modes);
  return measured;
}

// With the actuator's shapes in the unit of the structure: the residues are known.
MeasuredModes scaled(MeasuredModes measured, const std::vector<Hidden>& hidden) {
  State state = state_of(truth());
  for (const auto& one : hidden) effect(one.effect).apply(state, truth(), one.option, one.x);
  const ModeSolver solver(state_of(truth()), truth().mode_count());
  const MatrixXd inputs = solver.modes(state, 60.0, 1e5).inputs;
  const MatrixXd shapes = inputs.leftCols(measured.count());
  Dice dice(77);
  const MatrixXd errors = 0.03 * dice.normal(shapes.rows(), shapes.cols());
  measured.inputs = truth().inputs.names;
  measured.input_shapes = shapes.cwiseProduct(errors.array().exp().matrix());
  measured.input_std = MatrixXd::Constant(shapes.rows(), shapes.cols(), 1e-3);
  measured.scaled = true;
  return measured;
}

MeasuredModes without_shapes(MeasuredModes measured) {
  measured.outputs.clear();
  measured.output_shapes.resize(0, measured.count());
  measured.output_std.resize(0, measured.count());
  return measured;
}

std::string told(const Diagnosis& found) {
  std::string text(name(found.verdict));
  const auto add = [&](const Explanation& one) {
    text += "\n  " + std::to_string(one.probability) + " lnZ " + std::to_string(one.log_evidence);
    for (const auto& cause : one.causes) {
      text += "; " + cause.effect + " P " + std::to_string(cause.probability);
      for (const auto& channel : cause.channels) text += " " + channel;
      for (const auto& number : cause.parameters) {
        text += " " + number.name + "=" + std::to_string(number.value) + "+-" +
                std::to_string(number.std);
      }
    }
  };
  add(found.best);
  for (std::size_t i = 0; i < std::min<std::size_t>(4, found.rivals.size()); ++i)
    add(found.rivals[i]);
  for (const auto& level : found.levels_after) {
    text += "\n  level " + level.of + " " + std::to_string(level.value) + " determined " +
            std::to_string(level.determined);
  }
  return text;
}

const CauseParameter& number(const Cause& cause, std::string_view name) {
  const auto found = std::ranges::find(cause.parameters, name, &CauseParameter::name);
  if (found == cause.parameters.end()) throw InvalidInput("no such number");
  return *found;
}

double level(const std::vector<ErrorLevel>& levels, std::string_view of) {
  const auto found = std::ranges::find(levels, of, &ErrorLevel::of);
  return found == levels.end() ? kNone : found->value;
}

// A cause is named, with one number within three of its deviations, which are of use.
void expect_named(const Diagnosis& found, std::string_view effect, std::string_view of,
                  double value, double largest_std) {
  EXPECT_EQ(found.verdict, Verdict::named) << told(found);
  ASSERT_EQ(found.best.causes.size(), 1U) << told(found);
  const auto& cause = found.best.causes.front();
  EXPECT_EQ(cause.effect, effect) << told(found);
  if (cause.effect != effect || of.empty()) return;
  const auto& one = number(cause, of);
  EXPECT_NEAR(one.value, value, 3.0 * one.std) << told(found);
  EXPECT_LT(one.std, largest_std) << told(found);
}

void expect_place(const Diagnosis& found, const Vector2d& place) {
  ASSERT_FALSE(found.best.causes.empty());
  const auto& cause = found.best.causes.front();
  if (!cause.place) return;
  for (const auto& [axis, value] : {std::pair{"u", place(0)}, std::pair{"v", place(1)}}) {
    const auto& one = number(cause, axis);
    EXPECT_NEAR(one.value, value, 3.0 * one.std) << told(found);
    EXPECT_LT(one.std, 0.05) << told(found);
  }
}

DiagnosisOptions options() {
  DiagnosisOptions all;
  all.most_causes = 1;
  return all;
}

class DiagnosedModes : public testing::Test {
 protected:
  void SetUp() override { set_thread_count(1); }
  void TearDown() override { set_thread_count(before_); }

 private:
  int before_ = thread_count();
};

TEST_F(DiagnosedModes, FindNothingWhereNothingIsHidden) {
  EVERY_FOURTH_LANDING();
  for (const unsigned seed : {1U, 2U}) {
    const auto found = diagnosed(study(), measured_with({}, seed), options());
    EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << seed << told(found);
    EXPECT_TRUE(found.best.causes.empty());
    const double frequency = level(found.levels_after, "frequency");
    const double shape = level(found.levels_after, "shape");
    EXPECT_LT(std::abs(std::log(frequency / kFrequencyError)), std::log(1.6)) << told(found);
    EXPECT_LT(std::abs(std::log(shape / kShapeError)), std::log(1.6)) << told(found);
  }
}

Hidden stiffer() { return {"youngs_modulus", 0, VectorXd::Constant(1, std::log(1.12))}; }

// Residues tell the modulus from the density and the thickness.
TEST_F(DiagnosedModes, NameTheModulusWhereResiduesAreKnown) {
  EVERY_FOURTH_LANDING();
  const auto found =
      diagnosed(study(), scaled(measured_with({stiffer()}, 3), {stiffer()}), options());
  expect_named(found, "youngs_modulus", "relative", 0.12, 0.04);
}

// However far off it is: no other body has frequencies that fit so well.
TEST_F(DiagnosedModes, NameAModulusThatIsFarOffWhereTheFrequenciesFit) {
  EVERY_EIGHTH_LANDING();
  const Hidden hidden{"youngs_modulus", 0, VectorXd::Constant(1, std::log(2.5))};
  const auto found = diagnosed(study(), scaled(measured_with({hidden}, 3), {hidden}), options());
  expect_named(found, "youngs_modulus", "relative", 1.5, 0.2);
}

// Nothing else does: all of them are told, and none is sure.
TEST_F(DiagnosedModes, AreInDoubtAboutTheModulusBesideItsRivals) {
  EVERY_FOURTH_LANDING();
  for (const bool shapes : {true, false}) {
    const auto measured = measured_with({stiffer()}, 3);
    const auto found = diagnosed(study(), shapes ? measured : without_shapes(measured), options());
    std::vector<Explanation> all{found.best};
    all.insert(all.end(), found.rivals.begin(), found.rivals.end());
    double sum = 0.0;
    for (const auto& one : all) {
      if (one.causes.size() != 1) continue;
      const auto& cause = one.causes.front();
      for (const std::string_view body : {"youngs_modulus", "density", "thickness", "size_error"}) {
        if (cause.effect == body) sum += one.probability;
      }
      if (cause.effect != "youngs_modulus") continue;
      const auto& relative = number(cause, "relative");
      EXPECT_NEAR(relative.value, 0.12, 3.0 * relative.std) << told(found);
      EXPECT_GT(one.probability, 0.1) << told(found);
    }
    EXPECT_EQ(found.verdict, Verdict::ambiguous) << told(found);
    EXPECT_GT(sum, 0.8) << told(found);
  }
}

TEST_F(DiagnosedModes, NameAMass) {
  const Vector2d place(0.21, 0.08);
  const double mass = 0.012 * study().mass_kg;
  const Hidden hidden{"point_mass", 0, Vector3d(mass, place(0), place(1))};
  const auto found = diagnosed(study(), measured_with({hidden}, 4), options());
  expect_named(found, "point_mass", "mass", mass, mass);
  expect_place(found, place);
}

TEST_F(DiagnosedModes, NameASpring) {
  EVERY_FOURTH_LANDING();
  const Vector2d place(-0.18, 0.11);
  const Hidden hidden{"ground_spring", 0, Vector3d(std::log(3e6), place(0), place(1))};
  const auto found = diagnosed(study(), measured_with({hidden}, 5), options());
  expect_named(found, "ground_spring", "stiffness", 3e6, 3e6);
  expect_place(found, place);
}

// On soft strings the first mode is that of a rigid body, and springs that change the others are
// thousands of times stiffer than what would change it.
TEST_F(DiagnosedModes, NameASpringThatIsStiffBesideASuspension) {
  EVERY_FOURTH_LANDING();
  Structure hung = study();
  hung.frequency_hz.head(hung.rigid_count).setConstant(5.0);
  hung.rigid_count = 0;
  const Vector2d place(-0.18, 0.11);
  const Hidden hidden{"ground_spring", 0, Vector3d(std::log(3e6), place(0), place(1))};
  auto with = options();
  with.only = {"ground_spring", "point_mass", "youngs_modulus", "sensor_gain"};
  const auto found = diagnosed(hung, measured_with({hidden}, 5), with);
  expect_named(found, "ground_spring", "stiffness", 3e6, 3e6);
  expect_place(found, place);
}

TEST_F(DiagnosedModes, NameAGain) {
  EVERY_FOURTH_LANDING();
  const Hidden hidden{"sensor_gain", 4, VectorXd::Constant(1, std::log(1.3))};
  const auto found = diagnosed(study(), measured_with({hidden}, 6), options());
  expect_named(found, "sensor_gain", "relative", 0.3, 0.1);
  EXPECT_EQ(found.best.causes.front().channels, std::vector<std::string>{"s5"});
}

TEST_F(DiagnosedModes, NameASign) {
  EVERY_FOURTH_LANDING();
  const auto found = diagnosed(study(), measured_with({{"sensor_sign", 7, {}}}, 7), options());
  expect_named(found, "sensor_sign", "", 0.0, 0.0);
  EXPECT_EQ(found.best.causes.front().channels, std::vector<std::string>{"s8"});
}

TEST_F(DiagnosedModes, NameSwappedSensors) {
  EVERY_FOURTH_LANDING();
  const auto found = diagnosed(study(), measured_with({{"swapped_sensors", 14, {}}}, 8), options());
  expect_named(found, "swapped_sensors", "", 0.0, 0.0);
  EXPECT_EQ(found.best.causes.front().channels, effect("swapped_sensors").channels(study(), 14));
}

TEST_F(DiagnosedModes, NameAMovedSensor) {
  EVERY_FOURTH_LANDING();
  const Hidden hidden{"sensor_position", 5, Vector2d(0.02, -0.012)};
  const auto found = diagnosed(study(), measured_with({hidden}, 9), options());
  expect_named(found, "sensor_position", "u", 0.02, 0.01);
  const auto& cause = found.best.causes.front();
  EXPECT_EQ(cause.channels, std::vector<std::string>{"s6"});
  EXPECT_NEAR(number(cause, "v").value, -0.012, 3.0 * number(cause, "v").std);
}

// Levels that are known, and right.
TEST_F(DiagnosedModes, WorkWithKnownLevels) {
  EVERY_FOURTH_LANDING();
  auto with = options();
  with.levels = Levels::known;
  with.tolerances.frequency = kFrequencyError;
  with.tolerances.response = kShapeError;
  const auto nothing = diagnosed(study(), measured_with({}, 1), with);
  EXPECT_EQ(nothing.verdict, Verdict::no_discrepancy) << told(nothing);
  EXPECT_TRUE(nothing.levels_after.empty());
  with.only = {"sensor_gain", "sensor_sign", "sensor_position", "point_mass", "youngs_modulus"};
  const Hidden hidden{"sensor_gain", 4, VectorXd::Constant(1, std::log(1.3))};
  const auto found = diagnosed(study(), measured_with({hidden}, 6), with);
  expect_named(found, "sensor_gain", "relative", 0.3, 0.1);
}

TEST_F(DiagnosedModes, LookOnlyForWhatIsAskedFor) {
  auto with = options();
  with.only = {"sensor_position", "density"};
  const auto found = diagnosed(study(), measured_with({{"sensor_sign", 7, {}}}, 7), with);
  const auto expect_known = [&](const Explanation& one) {
    for (const auto& cause : one.causes) {
      EXPECT_TRUE(cause.effect == "sensor_position" || cause.effect == "density") << cause.effect;
    }
  };
  expect_known(found.best);
  for (const auto& rival : found.rivals) expect_known(rival);
  EXPECT_NE(found.verdict, Verdict::named) << told(found);
  EXPECT_NE(found.verdict, Verdict::no_discrepancy) << told(found);
  with.only = {"sensor_sing"};
  EXPECT_THROW((void)diagnosed(study(), measured_with({}, 1), with), InvalidInput);
}

// Not one bit depends on the number of threads, nor on what was diagnosed before.
TEST_F(DiagnosedModes, AreTheSameEachTime) {
  EVERY_FOURTH_LANDING();
  auto with = options();
  with.most_causes = 2;
  with.only = {"point_mass", "youngs_modulus", "sensor_gain", "swapped_sensors", "ground_spring"};
  const Hidden mass{"point_mass", 0, Vector3d(0.2, 0.21, 0.08)};
  const Hidden gain{"sensor_gain", 4, VectorXd::Constant(1, std::log(1.3))};
  const auto measured = measured_with({mass, gain}, 10, 8);
  const auto numbers = [&] {
    const auto found = diagnosed(study(), measured, with);
    std::vector<double> all;
    const auto add = [&](const Explanation& one) {
      all.insert(all.end(), {one.probability, one.log_evidence});
      for (const auto& cause : one.causes) {
        for (const auto& part : cause.parameters) all.insert(all.end(), {part.value, part.std});
      }
    };
    add(found.best);
    for (const auto& rival : found.rivals) add(rival);
    for (const auto& one : found.levels_after) all.push_back(one.value);
    for (const auto& mode : found.modes) all.insert(all.end(), {mode.after_hz, mode.mac_after});
    return all;
  };
  const auto first = numbers();
  EXPECT_GT(first.size(), 60U);
  EXPECT_EQ(numbers(), first);
  set_thread_count(2);
  EXPECT_EQ(numbers(), first);
}

TEST_F(DiagnosedModes, LeaveOutAnUnknownChannelWithANote) {
  auto measured = measured_with({}, 1, 8);
  measured.outputs[3] = "elsewhere";
  auto with = options();
  with.only = {"youngs_modulus"};
  const auto found = diagnosed(study(), measured, with);
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes.front().find("elsewhere"), std::string::npos);
  EXPECT_EQ(found.modes.size(), 8U);
}

// Damping ratios and deviations of what was not measured are of no interest.
TEST_F(DiagnosedModes, MayLackNumbers) {
  auto measured = measured_with({}, 1, 6);
  measured.damping_ratio.setConstant(kNone);
  measured.damping_std.setConstant(kNone);
  measured.output_shapes(3, 2) = {kNone, kNone};
  measured.output_std(3, 2) = kNone;
  auto with = options();
  with.only = {"youngs_modulus", "sensor_gain"};
  const auto found = diagnosed(study(), measured, with);
  EXPECT_TRUE(std::isfinite(found.best.log_evidence));
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << told(found);
}

// A fit without the bad channel takes it for the scatter of all channels where there are few.
TEST_F(DiagnosedModes, NameTheBadOneOfFewChannels) {
  EVERY_FOURTH_LANDING();
  auto measured = scaled(measured_with({{"sensor_gain", 2, VectorXd::Constant(1, -0.65)}}, 9), {});
  measured.outputs.resize(4);
  measured.output_shapes.conservativeResize(4, Eigen::NoChange);
  measured.output_std.conservativeResize(4, Eigen::NoChange);
  const auto found = diagnosed(study(), measured);
  ASSERT_EQ(found.verdict, Verdict::named) << told(found);
  EXPECT_EQ(found.best.causes.front().effect, "sensor_gain") << told(found);
  EXPECT_EQ(found.best.causes.front().channels, std::vector<std::string>{"s3"});
}

}  // namespace
}  // namespace chladni::diagnosis
