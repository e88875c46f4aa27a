// Laws of constants that are calibrated in every hypothesis about measured modes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/effect.h"
#include "diagnosis/modes/recorded_modes.h"
#include "host/parallel.h"
#include "rotation/turn.h"
#include "simulators/plates/ritz_structure.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulators::Dice;
using Kind = CalibratedConstant::Kind;

constexpr double kFrequencyError = 0.01, kShapeError = 0.05;

simulators::RitzBody plate() {
  auto body = simulators::aluminium_table(8);
  body.width = 0.47;
  return body;
}

Structure structure_of(const simulators::RitzBody& body, Index modes) {
  simulators::TableChannels channels;
  channels.outputs.resize(13, 2);
  channels.outputs << -0.27, -0.19, -0.06, -0.21, 0.13, -0.17, 0.28, -0.2, -0.22, -0.07, 0.02,
      -0.05, 0.2, -0.03, -0.29, 0.06, -0.1, 0.09, 0.09, 0.12, 0.26, 0.14, -0.19, 0.21, 0.11, 0.22;
  channels.inputs.resize(1, 2);
  channels.inputs << 0.25, -0.16;
  for (Index i = 1; i <= 13; ++i) channels.output_names.push_back("s" + std::to_string(i));
  channels.input_names = {"a1"};
  simulators::RitzStructureOptions options;
  options.modes = modes;
  options.cells = 6;
  options.fine = 6;
  options.scan = 11;
  return simulators::ritz_structure(simulators::ritz_modes(body), channels, options);
}

const Structure& study() {
  static const Structure made = structure_of(plate(), 24);
  return made;
}

// A plate as it really is, and what is hidden on it.
struct Truth {
  simulators::RitzBody body = plate();
  double damping = 1.0;
  double mass = 0.0;  // [kg] of a point mass at (0.17, 0.11)
};

MeasuredModes measured_on(const Truth& truth, unsigned seed, bool scaled = false,
                          bool shapes = true) {
  const Structure real = structure_of(truth.body, 50);
  State state = state_of(real);
  if (truth.mass > 0.0) {
    effect("point_mass").apply(state, real, 0, Eigen::Vector3d(truth.mass, 0.17, 0.11));
  }
  const RecordedModes exact = ModeSolver(state_of(real), 50).modes(state, 40.0, 1e5);
  constexpr Index kModes = 12;
  Dice dice(seed);
  MeasuredModes measured;
  measured.frequency_hz = exact.frequency_hz.head(kModes);
  for (double& hz : measured.frequency_hz) hz *= std::exp(kFrequencyError * dice.normal());
  std::sort(measured.frequency_hz.begin(), measured.frequency_hz.end());
  measured.frequency_std = VectorXd::Constant(kModes, 1e-4);
  measured.damping_ratio = truth.damping * exact.damping_ratio.head(kModes);
  for (double& ratio : measured.damping_ratio) ratio *= std::exp(0.1 * dice.normal());
  measured.damping_std = VectorXd::Constant(kModes, 0.02);
  const auto put = [&](const MatrixXd& all, Eigen::MatrixXcd& values, MatrixXd& std) {
    MatrixXd own = all.leftCols(kModes);
    std.resize(own.rows(), kModes);
    for (Index k = 0; k < kModes; ++k) {
      const double size = all.norm() / std::sqrt(static_cast<double>(all.size()));
      own.col(k) += kShapeError * size * dice.normal(own.rows(), 1);
      std.col(k).setConstant(5e-3 * size);
    }
    values = own.cast<std::complex<double>>();
  };
  if (shapes) measured.outputs = real.outputs.names;
  if (scaled) measured.inputs = real.inputs.names;
  put(shapes ? exact.outputs : MatrixXd(0, exact.count()), measured.output_shapes,
      measured.output_std);
  put(scaled ? exact.inputs : MatrixXd(0, exact.count()), measured.input_shapes,
      measured.input_std);
  measured.scaled = scaled;
  return measured;
}

CalibratedConstant constant(std::string effect, double deviation, Kind kind = Kind::known) {
  return {effect, "1", 1.0, effect, deviation, kind};
}

DiagnosisOptions with(std::vector<CalibratedConstant> constants, int most_causes = 1) {
  DiagnosisOptions options;
  options.most_causes = most_causes;
  options.constants = std::move(constants);
  return options;
}

std::string told(const Diagnosis& found) {
  std::string text(name(found.verdict));
  for (const auto& one : found.constants) {
    text += "\n  " + one.name + " " + std::to_string(one.value) + "+-" + std::to_string(one.std) +
            (one.determined ? "" : " (not determined)");
  }
  for (const auto& pair : found.constants_in_pairs) {
    text += "\n  " + pair.one + " " + pair.other + " r " + std::to_string(pair.correlation);
  }
  const auto add = [&](const Explanation& one) {
    text += "\n  " + std::to_string(one.probability) + " lnZ " + std::to_string(one.log_evidence);
    for (const auto& cause : one.causes) {
      text += "; " + cause.effect;
      for (const auto& number : cause.parameters) {
        text += " " + number.name + "=" + std::to_string(number.value) + "+-" +
                std::to_string(number.std);
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

const CalibratedNumber& number(const Diagnosis& found, std::string_view name) {
  const auto one = std::ranges::find(found.constants, name, &CalibratedNumber::name);
  if (one == found.constants.end()) throw InvalidInput("no such constant");
  return *one;
}

void expect_within_two(const Diagnosis& found, std::string_view name, double factor) {
  const auto& one = number(found, name);
  EXPECT_NEAR(one.value, factor, 2.0 * one.std) << name << told(found);
}

double level(const Diagnosis& found, std::string_view of) {
  const auto one = std::ranges::find(found.levels_after, of, &ErrorLevel::of);
  return one == found.levels_after.end() ? std::numeric_limits<double>::quiet_NaN() : one->value;
}

bool notes_say(const Diagnosis& found, std::string_view part) {
  return std::ranges::any_of(
      found.notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

simulators::RitzBody stiffer(double factor) {
  auto body = plate();
  auto& q = body.stiffness;
  for (double* one : {&q.q11, &q.q12, &q.q22, &q.q66, &q.shear}) *one *= factor;
  return body;
}

class CalibratedConstants : public testing::Test {
 protected:
  void SetUp() override { set_thread_count(1); }
  void TearDown() override { set_thread_count(before_); }

 private:
  int before_ = thread_count();
};

TEST_F(CalibratedConstants, AModulusIsFoundAndNoCauseIs) {
  EVERY_FOURTH_LANDING();
  for (const unsigned seed : {1U, 2U}) {
    for (const double factor : {1.12, 0.85}) {
      const auto found = diagnosed(study(), measured_on({.body = stiffer(factor)}, seed),
                                   with({constant("youngs_modulus", 0.15)}));
      EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << told(found);
      expect_within_two(found, "youngs_modulus", factor);
      EXPECT_LT(number(found, "youngs_modulus").std, 0.02) << told(found);
      EXPECT_GT(level(found, "frequency"), 0.5 * kFrequencyError) << told(found);
      EXPECT_LT(level(found, "frequency"), 2.0 * kFrequencyError) << told(found);
    }
  }
}

TEST_F(CalibratedConstants, FrequenciesAloneAreEnough) {
  EVERY_FOURTH_LANDING();
  for (const double factor : {1.12, 1.7, 0.55}) {
    const auto found = diagnosed(study(), measured_on({.body = stiffer(factor)}, 3, false, false),
                                 with({constant("youngs_modulus", 0.0, Kind::unknown)}));
    EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << told(found);
    expect_within_two(found, "youngs_modulus", factor);
  }
}

TEST_F(CalibratedConstants, AMassBesideIsStillNamed) {
  EVERY_FOURTH_LANDING();
  const auto found = diagnosed(study(), measured_on({.body = stiffer(1.12), .mass = 0.8}, 1, true),
                               with({constant("youngs_modulus", 0.15)}));
  EXPECT_EQ(found.verdict, Verdict::named) << told(found);
  ASSERT_EQ(found.best.causes.size(), 1U) << told(found);
  EXPECT_EQ(found.best.causes[0].effect, "point_mass") << told(found);
  expect_within_two(found, "youngs_modulus", 1.12);
}

TEST_F(CalibratedConstants, ModulusAndDensityAreNotToldApartWithoutScale) {
  EVERY_FOURTH_LANDING();
  const auto found = diagnosed(study(), measured_on({.body = stiffer(1.12)}, 1),
                               with({constant("youngs_modulus", 0.15), constant("density", 0.15)}));
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << told(found);
  EXPECT_TRUE(notes_say(found, "youngs_modulus and density apart")) << told(found);
  // Half of each prior's variance is left in the direction that no datum sees.
  const double left = 0.15 / std::sqrt(2.0);
  for (const auto* name : {"youngs_modulus", "density"}) {
    const auto& one = number(found, name);
    EXPECT_GT(one.std / one.value, 0.95 * left) << told(found);
  }
  ASSERT_EQ(found.constants_in_pairs.size(), 1U) << told(found);
  EXPECT_GT(found.constants_in_pairs[0].correlation, 0.95);
}

TEST_F(CalibratedConstants, AScaleTellsModulusAndDensityApart) {
  const auto found = diagnosed(study(), measured_on({.body = stiffer(1.12)}, 1, true),
                               with({constant("youngs_modulus", 0.15), constant("density", 0.15)}));
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << told(found);
  EXPECT_FALSE(notes_say(found, "apart")) << told(found);
  expect_within_two(found, "youngs_modulus", 1.12);
  expect_within_two(found, "density", 1.0);
}

TEST_F(CalibratedConstants, WhatIsKnownExactlyChangesNothing) {
  EVERY_FOURTH_LANDING();
  for (const double mass : {0.0, 0.8}) {
    const auto measured = measured_on({.mass = mass}, 2, true);
    const auto before = diagnosed(study(), measured, with({}));
    const auto after = diagnosed(study(), measured,
                                 with({constant("youngs_modulus", 0.0), constant("density", 0.0),
                                       constant("thickness", 0.0)}));
    EXPECT_EQ(before.verdict, after.verdict) << told(before) << told(after);
    ASSERT_EQ(before.best.causes.size(), after.best.causes.size());
    EXPECT_NEAR(before.best.log_evidence, after.best.log_evidence, 0.5)
        << told(before) << told(after);
    for (std::size_t c = 0; c < before.best.causes.size(); ++c) {
      const auto& one = before.best.causes[c];
      const auto& other = after.best.causes[c];
      EXPECT_EQ(one.effect, other.effect);
      for (std::size_t i = 0; i < one.parameters.size(); ++i) {
        EXPECT_NEAR(one.parameters[i].value, other.parameters[i].value,
                    0.2 * one.parameters[i].std);
        EXPECT_NEAR(one.parameters[i].std, other.parameters[i].std, 0.1 * one.parameters[i].std);
      }
    }
  }
}

TEST_F(CalibratedConstants, ABlunderInWhatWasMeasuredIsACause) {
  EVERY_FOURTH_LANDING();
  auto body = plate();
  body.thickness *= 1.08;
  const auto measured = measured_on({.body = body}, 1);
  const auto as_measured =
      diagnosed(study(), measured, with({constant("thickness", 0.006, Kind::measured)}));
  EXPECT_NE(as_measured.verdict, Verdict::no_discrepancy) << told(as_measured);
  EXPECT_FALSE(as_measured.best.causes.empty()) << told(as_measured);
  const auto as_known = diagnosed(study(), measured, with({constant("thickness", 0.08)}));
  EXPECT_EQ(as_known.verdict, Verdict::no_discrepancy) << told(as_known);
  expect_within_two(as_known, "thickness", 1.08);
}

TEST_F(CalibratedConstants, DirectionsOfTheStiffnessAreFound) {
  EVERY_FOURTH_LANDING();
  auto body = plate();
  auto& q = body.stiffness;
  q.q11 *= 1.3;
  q.q22 *= 0.7;
  q.q12 *= 0.7;
  q.q66 *= 1.15;
  const auto found =
      diagnosed(study(), measured_on({.body = body}, 1),
                with({constant("stiffness_along_u", 0.25), constant("stiffness_along_v", 0.25),
                      constant("shear_stiffness", 0.25), constant("density", 0.01)}));
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << told(found);
  expect_within_two(found, "stiffness_along_u", 1.3);
  expect_within_two(found, "stiffness_along_v", 0.7);
  expect_within_two(found, "shear_stiffness", 1.15);
  EXPECT_FALSE(number(found, "density").determined) << told(found);
}

// Frequencies of a square do not say along which side it is stiffer.
TEST_F(CalibratedConstants, OtherConstantsThatFitAsWellAreTold) {
  auto square = plate();
  square.width = square.length;
  auto stiffer_along_u = square;
  auto& q = stiffer_along_u.stiffness;
  q.q11 *= 1.35;
  const auto found =
      diagnosed(structure_of(square, 24), measured_on({.body = stiffer_along_u}, 1, false, false),
                with({constant("stiffness_along_u", 0.25), constant("stiffness_along_v", 0.25),
                      constant("shear_stiffness", 0.05)},
                     0));
  EXPECT_TRUE(notes_say(found, "other constants fit nearly as well")) << told(found);
  const double high =
      std::max(number(found, "stiffness_along_u").value, number(found, "stiffness_along_v").value);
  EXPECT_NEAR(high, 1.35, 0.1) << told(found);
}

TEST_F(CalibratedConstants, ADampingRatioIsFound) {
  const auto found = diagnosed(study(), measured_on({.damping = 2.2}, 1),
                               with({constant("modal_damping", 0.0, Kind::unknown)}));
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << told(found);
  expect_within_two(found, "modal_damping", 2.2);
}

TEST_F(CalibratedConstants, AreRefusedInWords) {
  const auto measured = measured_on({}, 1);
  const auto expect = [&](const std::vector<CalibratedConstant>& constants, const char* part) {
    try {
      static_cast<void>(diagnosed(study(), measured, with(constants)));
      FAIL() << part;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  expect({constant("point_mass", 0.1)}, "no constant");
  expect({constant("density", -0.1)}, "negative");
  expect({constant("density", 0.1), constant("density", 0.1)}, "twice");
  expect({constant("density", 0.0, Kind::measured)}, "above 0");
}

TEST_F(CalibratedConstants, KeepTheirValueWhereTheModelDoesNotShowThem) {
  Structure solid = study();
  solid.bending_power = 0.0;
  solid.directional = {};
  const auto found = diagnosed(solid, measured_on({}, 1), with({constant("thickness", 0.1)}, 0));
  EXPECT_TRUE(found.constants.empty());
  EXPECT_TRUE(notes_say(found, "thickness keeps its value")) << told(found);
}

}  // namespace
}  // namespace chladni::diagnosis
