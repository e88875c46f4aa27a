// Constants of a study that are not known, calibrated by responses.
#include "diagnosis/verdict/constants_fitted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "base/draw.h"
#include "base/error.h"
#include "diagnosis/calibrated_responses.h"
#include "diagnosis/modes/calibration/constants_told.h"
#include "diagnosis/modes/recorded_modes.h"
#include "diagnosis/small_plate.h"
#include "rotation/turn.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

CalibratedConstant modulus_within(double part) {
  return {.name = "material.youngs_modulus",
          .unit = "Pa",
          .value = 70e9,
          .effect = "youngs_modulus",
          .deviation = part,
          .kind = CalibratedConstant::Kind::known};
}

CalibratedNumber starting_at(double relative) {
  return {.name = "material.youngs_modulus",
          .unit = "Pa",
          .effect = "youngs_modulus",
          .of_study = 70e9,
          .value = 70e9 * (1.0 + relative),
          .std = 1e9,
          .prior = 0.1,
          .determined = true};
}

std::vector<HeldConstant> held(const std::vector<CalibratedConstant>& constants) {
  std::vector<std::string> notes;
  return held_constants(small_plate(), constants, Tolerances{}, notes);
}

// The plate with another modulus and more, on 80 lines with 1 % of noise.
modal::FrfSet measured(double relative, const std::vector<Supposed>& causes, unsigned seed) {
  const auto& plate = small_plate();
  State state = state_of(plate);
  const auto modulus = held({modulus_within(0.1)});
  const auto stiffer = constant_deviations(plate, modulus, VectorXd::Zero(1));
  stiffer.front().apply(state, std::log1p(relative) / modulus.front().width);
  for (const auto& cause : causes) change_of(cause, plate)(state);
  modal::FrfSet set;
  for (const auto& name : plate.outputs.names) set.outputs.emplace_back().name = name;
  for (const auto& name : plate.inputs.names) set.inputs.emplace_back().name = name;
  set.frequency_hz = VectorXd::LinSpaced(80, 31.0, 893.0);
  const auto all = responses(state, 2.0 * 3.14159265358979 * set.frequency_hz);
  Draw draw(seed);
  for (Index k = 0; k < all.rows(); ++k) {
    Eigen::MatrixXcd value =
        all.row(k).transpose().reshaped(plate.output_count(), plate.input_count());
    const Eigen::MatrixXd sigma = 0.01 * value.cwiseAbs();
    for (Index e = 0; e < value.size(); ++e) {
      const double real = draw.normal();
      value(e) += std::sqrt(0.5) * sigma(e) * std::complex<double>(real, draw.normal());
    }
    set.value.push_back(value);
    set.variance.emplace_back(sigma.cwiseAbs2());
  }
  return set;
}

DiagnosisOptions options(double within) {
  DiagnosisOptions options;
  options.constants = {modulus_within(within)};
  options.only = {"youngs_modulus", "point_mass", "sensor_gain"};
  options.lines = 80;
  return options;
}

// Modes below 900 Hz as a fit of responses has them.
MeasuredModes modes_of_plate_stiffer_by(double relative) {
  const auto& plate = small_plate();
  State state = state_of(plate);
  scale_stiffness(state, 1.0 + relative);
  const auto modes = ModeSolver(state, plate.mode_count()).modes(state, 0.0, 900.0);
  MeasuredModes all;
  all.outputs = plate.outputs.names;
  all.inputs = plate.inputs.names;
  all.frequency_hz = modes.frequency_hz;
  all.frequency_std = VectorXd::Constant(modes.count(), 1e-4);
  all.damping_ratio = modes.damping_ratio;
  all.damping_std = VectorXd::Constant(modes.count(), 0.02);
  all.output_shapes = modes.outputs.cast<std::complex<double>>();
  all.input_shapes = modes.inputs.cast<std::complex<double>>();
  all.output_std = 0.01 * modes.outputs.cwiseAbs();
  all.input_std = 0.01 * modes.inputs.cwiseAbs();
  return all;
}

TEST(ConstantsFitted, AreTheirEffectAtTheStartAndWidthsBeyond) {
  const auto& plate = small_plate();
  const auto constants = held({modulus_within(0.1)});
  const VectorXd start = start_of(constants, {starting_at(0.05)});
  ASSERT_EQ(start.size(), 1);
  EXPECT_NEAR(start(0), std::log(1.05), 1e-12);
  State moved = state_of(plate), stated = state_of(plate);
  constant_deviations(plate, constants, start).front().apply(moved, 0.3);
  constants.front().effect->apply(stated, plate, 0,
                                  VectorXd::Constant(1, std::log(1.05) + 0.3 * 0.1));
  EXPECT_TRUE(moved.stiffness.isApprox(stated.stiffness, 1e-14));
  auto open = starting_at(0.05);
  open.determined = false;
  EXPECT_EQ(start_of(constants, {open})(0), 0.0);
  EXPECT_EQ(start_of(constants, {})(0), 0.0);
}

// The start is not the study's value: a deviation of 0 is the start.
TEST(ConstantsFitted, AreAtTheirStartWhereTheirDeviationIsZero) {
  const auto& plate = small_plate();
  const auto constants = held({modulus_within(0.1)});
  const auto free = constant_deviations(plate, constants, VectorXd::Constant(1, std::log(1.05)));
  const auto stiffness = [&](double eta) {
    return deviating(plate, free, VectorXd::Constant(1, eta)).stiffness;
  };
  EXPECT_TRUE(stiffness(0.0).isApprox(stiffness(1e-9), 1e-9));
  EXPECT_FALSE(stiffness(0.0).isApprox(state_of(plate).stiffness, 1e-3));
}

// A constant that the data do not determine has the study's value, wherever the fit left it.
TEST(ConstantsFitted, KeepTheStudysValueWhereNothingDeterminesThem) {
  const auto constants = held({modulus_within(0.1)});
  const double width = constants.front().width;
  Diagnosis diagnosis;
  tell_constants(constants, VectorXd::Constant(1, std::log(0.9)),
                 Eigen::MatrixXd::Constant(1, 1, width * width), diagnosis);
  ASSERT_EQ(diagnosis.constants.size(), 1U);
  const auto& told = diagnosis.constants.front();
  EXPECT_FALSE(told.determined);
  EXPECT_EQ(told.value, told.of_study);
  EXPECT_NEAR(told.std, told.prior * told.of_study, 1e-12 * told.of_study);
}

TEST(ConstantsFitted, HaveTheDeviationsOfTheFit) {
  const auto constants = held({modulus_within(0.1)});
  Fit fit;
  fit.causes = {{&effect("point_mass"), 0, Eigen::Vector3d(0.01, 0.0, 0.0)}};
  fit.eta = Eigen::Vector3d(5.0, 0.5, 7.0);
  fit.covariance = Eigen::MatrixXd::Identity(6, 6);
  fit.covariance(4, 4) = 0.04;
  const auto found = constants_of(fit, constants, VectorXd::Constant(1, 0.02), 1);
  EXPECT_NEAR(found.x(0), 0.02 + 0.1 * 0.5, 1e-14);
  EXPECT_NEAR(std::sqrt(found.covariance(0, 0)), 0.1 * 0.2, 1e-14);
}

// 8 % are some ten bandwidths of frequency. Without the constant that is a cause, with it none.
TEST(ConstantsFitted, AreNoCauseWhereTheyWereNotKnown) {
  EVERY_FOURTH_LANDING();
  const auto set = measured(0.08, {}, 3);
  const auto calibrated = diagnosed(small_plate(), set, options(0.1), {{starting_at(0.075)}, {}});
  EXPECT_EQ(calibrated.verdict, Verdict::no_discrepancy);
  ASSERT_EQ(calibrated.constants.size(), 1U);
  const auto& modulus = calibrated.constants.front();
  EXPECT_NEAR(modulus.value, 1.08 * 70e9, 3.0 * modulus.std);
  EXPECT_LT(modulus.std, 0.01 * modulus.value);
  EXPECT_TRUE(modulus.determined);
  auto known = options(0.1);
  known.constants.clear();
  const auto named = diagnosed(small_plate(), set, known);
  ASSERT_EQ(named.best.causes.size(), 1U);
  EXPECT_EQ(named.best.causes.front().effect, "youngs_modulus");
  EXPECT_TRUE(named.constants.empty());
}

TEST(ConstantsFitted, StandBesideACause) {
  EVERY_EIGHTH_LANDING();
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.3, 0.1, -0.05)};
  const auto found = diagnosed(small_plate(), measured(-0.05, {mass}, 4), options(0.1),
                               {{starting_at(-0.06)}, {}});
  EXPECT_EQ(found.verdict, Verdict::named);
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_EQ(found.best.causes.front().effect, "point_mass");
  EXPECT_NEAR(found.best.causes.front().parameters.front().value, 0.3, 0.02);
  ASSERT_EQ(found.constants.size(), 1U);
  EXPECT_NEAR(found.constants.front().change(), -0.05,
              3.0 * found.constants.front().std / found.constants.front().of_study);
}

// From the study's modulus the fit ends far from the data; from the modes of the responses it does
// not, and a note tells of both.
TEST(ConstantsFitted, StartAlsoWhereTheModesAre) {
  EVERY_FOURTH_LANDING();
  const auto set = measured(0.14, {}, 6);
  const auto found =
      diagnosed(small_plate(), set, options(0.1), {{}, modes_of_plate_stiffer_by(0.14)});
  EXPECT_EQ(found.verdict, Verdict::no_discrepancy);
  ASSERT_EQ(found.constants.size(), 1U);
  EXPECT_NEAR(found.constants.front().value, 1.14 * 70e9, 3.0 * found.constants.front().std);
  EXPECT_TRUE(std::ranges::any_of(found.notes, [](const std::string& note) {
    return note.find("starts at the identified modes explains the responses better") !=
           std::string::npos;
  }));
}

TEST(ConstantsFitted, RefuseConstantsThatAreNone) {
  auto wrong = options(0.1);
  wrong.constants.front().effect = "colour";
  EXPECT_THROW(static_cast<void>(diagnosed(small_plate(), measured(0.0, {}, 5), wrong)),
               InvalidInput);
  wrong = options(0.1);
  wrong.constants.push_back(wrong.constants.front());
  EXPECT_THROW(static_cast<void>(diagnosed(small_plate(), measured(0.0, {}, 5), wrong)),
               InvalidInput);
}

}  // namespace
}  // namespace chladni::diagnosis
