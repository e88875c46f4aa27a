// What is wrong, before any cause: on measured structures that are known exactly.
#include "diagnosis/compare.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "simulators/frf_cases.h"

namespace chladni::diagnosis {
namespace {

using simulators::FrfCase;
using simulators::FrfFaults;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

FrfFaults noisy(double part, unsigned seed) {
  FrfFaults faults;
  faults.relative_noise = part;
  faults.seed = seed;
  return faults;
}

FrfFaults quiet() {
  FrfFaults faults = noisy(0.01, 1);
  faults.noisy = false;
  return faults;
}

const FrfCase& table() {
  static const FrfCase made = simulators::oat4x13(quiet());
  return made;
}

identification::ModalFit fit_of(const modal::ReducedModel& model) {
  identification::ModalFit fit;
  fit.model = model;
  fit.frequency_std_hz = 0.01 * Eigen::VectorXd::Ones(model.mode_count());
  fit.damping_std = 1e-4 * Eigen::VectorXd::Ones(model.mode_count());
  fit.output_std = Eigen::MatrixXd::Zero(model.output_count(), model.mode_count());
  fit.input_std = Eigen::MatrixXd::Zero(model.mode_count(), model.input_count());
  return fit;
}

// The same responses of a structure whose flexible frequencies are `factor` times as high.
std::vector<Eigen::MatrixXcd> shifted(const FrfCase& of, double factor) {
  auto other = of.truth;
  other.frequency_hz *= factor;
  return modal::frf(other, of.measured.frequency_hz).value;
}

TEST(Compared, NothingIsWrongOfEqualResponses) {
  const auto& of = table();
  const auto found = compared(of.measured, of.exact);
  EXPECT_EQ(found.overall_error, 0.0);
  EXPECT_EQ(found.error.maxCoeff(), 0.0);
  EXPECT_EQ(found.band_error.maxCoeff(), 0.0);
  EXPECT_EQ(found.output_band_error.maxCoeff(), 0.0);
  EXPECT_EQ(found.input_band_error.maxCoeff(), 0.0);
  EXPECT_NEAR(found.frac.minCoeff(), 1.0, 1e-12);
  EXPECT_NEAR(found.shape_alike.minCoeff(), 1.0, 1e-12);
  EXPECT_NEAR(found.size_alike.minCoeff(), 1.0, 1e-12);
  EXPECT_EQ(found.level, 1.0);
  EXPECT_EQ(found.output_gain, Eigen::VectorXd::Ones(4));
  EXPECT_EQ(found.input_gain, Eigen::VectorXd::Ones(13));
  EXPECT_EQ(found.output_sign, Eigen::VectorXd::Ones(4));
  EXPECT_EQ(found.input_sign, Eigen::VectorXd::Ones(13));
  EXPECT_NEAR(found.output_alike.diagonal().minCoeff(), 1.0, 1e-12);
  EXPECT_EQ(found.chi_square.maxCoeff(), 0.0);
  EXPECT_TRUE(swaps(of.measured, of.exact).empty());
  EXPECT_EQ(found.band_edges_hz.size(), 9);
  EXPECT_NEAR(found.overall_noise, 0.01, 1e-4);
}

TEST(Compared, NoiseAloneIsWhiteAndAsLargeAsStated) {
  const auto of = simulators::oat4x13(noisy(0.02, 7));
  const auto found = compared(of.measured, of.exact);
  // Variance of |e|²/σ² is 1, of the lag-one correlation half of that, per line.
  const double lines = static_cast<double>(of.measured.line_count());
  EXPECT_LT((found.chi_square.array() - 1.0).abs().maxCoeff(), 5.0 / std::sqrt(lines));
  EXPECT_LT(found.lag_one.cwiseAbs().maxCoeff(), 5.0 / std::sqrt(2.0 * lines));
  EXPECT_NEAR(found.overall_error, found.overall_noise, 0.05 * found.overall_noise);
  const auto wrong = compared(of.measured, shifted(of, 1.002));
  EXPECT_GT(wrong.chi_square.minCoeff(), 2.0);
  EXPECT_GT(wrong.lag_one.minCoeff(), 0.5);  // an error of the model is no noise
}

TEST(Compared, ExchangedChannelsAreFound) {
  auto measured = table().measured;
  for (auto& value : measured.value) {
    value.row(0).swap(value.row(2));
    value.col(3).swap(value.col(11));
  }
  for (const double factor : {1.0, 1.004}) {
    const auto found = swaps(measured, shifted(table(), factor));
    ASSERT_EQ(found.size(), 2U) << factor;
    EXPECT_TRUE(found[0].outputs);
    EXPECT_EQ(found[0].first, 0);
    EXPECT_EQ(found[0].second, 2);
    EXPECT_FALSE(found[1].outputs);
    EXPECT_EQ(found[1].first, 3);
    EXPECT_EQ(found[1].second, 11);
    EXPECT_GT(found[1].alike_exchanged, found[1].alike);
  }
}

TEST(Compared, GainsAndSignsGoToTheirChannels) {
  FrfFaults faults = quiet();
  faults.output_gain = Eigen::Vector4d(1.0, -1.1, 1.0, 1.0);
  faults.input_gain = Eigen::VectorXd::Ones(13);
  faults.input_gain(4) = 0.8;
  faults.input_gain(9) = -1.0;
  auto of = simulators::oat4x13(faults);
  for (auto& value : of.measured.value) value *= 1.05;
  for (const double factor : {1.0, 1.004}) {
    const double tolerance = factor == 1.0 ? 1e-9 : 0.02;
    const auto found = compared(of.measured, shifted(table(), factor));
    EXPECT_NEAR(found.level, 1.05, tolerance) << factor;
    EXPECT_LT((found.output_gain - Eigen::Vector4d(1.0, 1.1, 1.0, 1.0)).cwiseAbs().maxCoeff(),
              tolerance);
    EXPECT_LT((found.input_gain - faults.input_gain.cwiseAbs()).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_EQ(found.output_sign, Eigen::Vector4d(1.0, -1.0, 1.0, 1.0));
    EXPECT_EQ(found.input_sign(9), -1.0);
    EXPECT_EQ(found.input_sign.sum(), 11.0);
  }
}

TEST(Compared, AScaleChangesSizeButNotShape) {
  auto measured = table().measured;
  for (auto& value : measured.value) value *= 1.2;
  const auto found = compared(measured, table().exact);
  EXPECT_NEAR(found.frac.minCoeff(), 1.0, 1e-12);
  EXPECT_NEAR(found.shape_alike.minCoeff(), 1.0, 1e-12);
  EXPECT_NEAR(found.size_alike.mean(), 2.0 * 1.2 / (1.0 + 1.44), 1e-12);
  EXPECT_NEAR(found.overall_error, 0.2 / 1.2, 1e-12);
  EXPECT_LT((found.band_error.array() - 0.2 / 1.2).abs().maxCoeff(), 1e-12);
}

TEST(Compared, WhatWasNotMeasuredIsNoError) {
  auto measured = table().measured;
  for (std::size_t k = 0; k < measured.value.size(); ++k) {
    measured.value[k](1, 2) = kNone;
    measured.variance[k](1, 2) = kNone;
    if (k % 2 == 0) measured.value[k](3, 3) = kNone;
  }
  const auto found = compared(measured, table().exact);
  EXPECT_TRUE(std::isnan(found.error(1, 2)));
  EXPECT_TRUE(std::isnan(found.frac(1, 2)));
  EXPECT_EQ(found.error(3, 3), 0.0);
  EXPECT_EQ(found.overall_error, 0.0);
  EXPECT_EQ(found.input_sign, Eigen::VectorXd::Ones(13));
  EXPECT_EQ(found.output_gain, Eigen::VectorXd::Ones(4));
  measured.variance.clear();
  EXPECT_TRUE(std::isnan(compared(measured, table().exact).chi_square(0, 0)));
}

TEST(Compared, AnErrorStaysInItsBand) {
  auto simulated = table().exact;
  const auto& f = table().measured.frequency_hz;
  for (Eigen::Index k = 0; k < f.size(); ++k) {
    if (f(k) > 1200.0) simulated[static_cast<std::size_t>(k)].row(2) *= 2.0;
  }
  const auto found = compared(table().measured, simulated);
  for (Eigen::Index b = 0; b < 8; ++b) {
    if (found.band_edges_hz(b + 1) < 1200.0) {
      EXPECT_EQ(found.band_error(b), 0.0) << b;
    }
    EXPECT_EQ(found.output_band_error(1, b), 0.0);
  }
  EXPECT_NEAR(found.output_band_error(2, 7), 1.0, 1e-12);
  EXPECT_GT(found.band_error(7), 0.1);
}

TEST(ComparedModes, OfAModelWithItselfAreEqual) {
  const auto& truth = table().truth;
  const auto found = compared(truth, fit_of(truth));
  const auto flexible = truth.mode_count() - truth.rigid_count;
  ASSERT_EQ(static_cast<Eigen::Index>(found.pairs.size()), flexible);
  for (const auto& pair : found.pairs) {
    EXPECT_EQ(pair.simulated, pair.measured);
    EXPECT_EQ(pair.change, 0.0);
    EXPECT_NEAR(pair.mac, 1.0, 1e-12);
    EXPECT_EQ(pair.measured_damping, pair.simulated_damping);
  }
  EXPECT_TRUE(found.simulated_alone.empty());
  EXPECT_TRUE(found.measured_alone.empty());
  EXPECT_NEAR(found.output_comac.minCoeff(), 1.0, 1e-12);
  EXPECT_NEAR(found.input_comac.minCoeff(), 1.0, 1e-12);
  EXPECT_NEAR(found.mac.diagonal().minCoeff(), 1.0, 1e-12);
}

TEST(ComparedModes, ScaleAndSignOfAShapeMeanNothing) {
  auto fit = fit_of(table().truth);
  fit.model.output_shapes *= -3.0;
  fit.model.input_shapes *= 0.2;
  for (const auto& pair : compared(table().truth, fit).pairs) EXPECT_NEAR(pair.mac, 1.0, 1e-12);
}

TEST(ComparedModes, ExchangedModesAndNewOnesAreTold) {
  auto measured = table().truth;
  const auto first = measured.rigid_count;
  // Two that are about a tenth apart in frequency change places.
  const auto& f = measured.frequency_hz;
  auto k = first + 11;
  while (f(k + 1) < 1.05 * f(k) || f(k + 1) > 1.2 * f(k)) ++k;
  measured.output_shapes.col(k).swap(measured.output_shapes.col(k + 1));
  measured.input_shapes.row(k).swap(measured.input_shapes.row(k + 1));
  measured.frequency_hz(first + 3) *= 1.01;
  const auto without = [](const modal::ReducedModel& of, Eigen::Index gone) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < of.mode_count(); ++i) {
      if (i != gone) kept.push_back(i);
    }
    auto result = of;
    result.frequency_hz = of.frequency_hz(kept);
    result.damping_ratio = of.damping_ratio(kept);
    result.output_shapes = of.output_shapes(Eigen::all, kept);
    result.input_shapes = of.input_shapes(kept, Eigen::all);
    return result;
  };
  // The measured structure lacks one mode and has another that the simulation lacks.
  const auto simulated = without(table().truth, first + 10);
  const auto found = compared(simulated, fit_of(without(measured, first + 5)), {.least_mac = 0.5});
  const auto partner_of = [&](Eigen::Index mode) {
    for (const auto& pair : found.pairs) {
      if (pair.simulated == mode) return pair.measured;
    }
    return Eigen::Index{-1};
  };
  // Either lacks one mode below them.
  EXPECT_EQ(partner_of(k - 1), k);
  EXPECT_EQ(partner_of(k), k - 1);
  ASSERT_EQ(found.pairs[3].simulated, first + 3);
  EXPECT_NEAR(found.pairs[3].change, 0.01, 1e-12);
  EXPECT_NEAR(found.pairs[3].change_std, 0.01 / simulated.frequency_hz(first + 3), 1e-12);
  ASSERT_EQ(found.simulated_alone.size(), 1U);
  EXPECT_EQ(found.simulated_alone[0].column, first + 5);
  ASSERT_EQ(found.measured_alone.size(), 1U);
  EXPECT_EQ(found.measured_alone[0].column, first + 9);
}

TEST(ComparedModes, ATurnedPairIsTheSamePair) {
  const auto of = simulators::pairs(0.0, 0.01, 0.01, quiet());
  auto measured = of.truth;
  Eigen::Index pair = 0;
  while (measured.frequency_hz(pair) != 100.0) ++pair;
  Eigen::Matrix2d turn;
  turn << std::cos(0.6), -std::sin(0.6), std::sin(0.6), std::cos(0.6);
  measured.output_shapes.middleCols(pair, 2) = measured.output_shapes.middleCols(pair, 2) * turn;
  measured.input_shapes.middleRows(pair, 2) =
      turn.transpose() * measured.input_shapes.middleRows(pair, 2);
  const auto found = compared(of.truth, fit_of(measured));
  ASSERT_EQ(found.pairs.size(), 4U);
  for (const auto& one : found.pairs) EXPECT_NEAR(one.mac, 1.0, 1e-9);
  EXPECT_NEAR(found.output_comac.minCoeff(), 1.0, 1e-9);
  EXPECT_LT(found.mac(pair, pair), 0.9);  // alone they would not be
}

TEST(ComparedModes, AWrongChannelHasTheLowestCoMac) {
  auto fit = fit_of(table().truth);
  const auto m = fit.model.mode_count();
  for (Eigen::Index k = 0; k < m; k += 2) fit.model.output_shapes(2, k) = 0.0;
  fit.output_std.row(1).setConstant(HUGE_VAL);  // and one that was not measured
  const auto found = compared(table().truth, fit, {.least_mac = 0.1});
  EXPECT_TRUE(std::isnan(found.output_comac(1)));
  EXPECT_LT(found.output_comac(2), 0.7);
  EXPECT_GT(found.output_comac(0), 0.8);
  EXPECT_GT(found.input_comac.minCoeff(), 0.999);
}

TEST(ComparedModes, WithoutAnyPairSayNothingOfChannels) {
  auto fit = fit_of(table().truth);
  fit.model.frequency_hz.tail(17) *= 1e3;
  const auto found = compared(table().truth, fit, {.least_mac = 1.1});
  EXPECT_TRUE(found.pairs.empty());
  EXPECT_TRUE(found.output_comac.hasNaN());
}

TEST(Reciprocal, PairsAnswerEachOther) {
  const auto of = simulators::beam5x5(quiet());
  const auto found = reciprocity(of.measured, of.truth);
  ASSERT_EQ(found.size(), 10U);
  for (const auto& one : found) {
    EXPECT_LT(one.difference, 1e-12);
    EXPECT_NEAR(one.ratio, 1.0, 1e-12);
  }
}

TEST(Reciprocal, AGainShowsAsARatioAndNoiseAsNoise) {
  FrfFaults faults = noisy(0.01, 3);
  faults.input_gain = Eigen::VectorXd::Ones(5);
  faults.input_gain(1) = 1.1;
  const auto of = simulators::beam5x5(faults);
  for (const auto& one : reciprocity(of.measured, of.truth)) {
    // G_ab is a's answer to b.
    const double expected = one.input_b == 1 ? 1.1 : one.input_a == 1 ? 1.0 / 1.1 : 1.0;
    EXPECT_NEAR(one.ratio, expected, 1.5 * one.noise);  // three deviations of its real part
    EXPECT_LT(one.left, 2.0 * one.noise);
    if (expected == 1.0) {
      EXPECT_LT(one.difference, 2.0 * one.noise);  // a few lines at the peaks hold most of it
    } else {
      EXPECT_GT(one.difference, 4.0 * one.noise);
    }
  }
}

Structure structure_of(const modal::ReducedModel& model) {
  Structure structure;
  structure.frequency_hz = model.frequency_hz;
  structure.damping_ratio = model.damping_ratio;
  structure.rigid_count = model.rigid_count;
  structure.outputs.shapes = model.output_shapes;
  structure.inputs.shapes = model.input_shapes.transpose();
  for (Eigen::Index i = 0; i < model.output_count(); ++i) {
    structure.outputs.names.push_back("y" + std::to_string(i + 1));
  }
  for (Eigen::Index j = 0; j < model.input_count(); ++j) {
    structure.inputs.names.push_back("u" + std::to_string(j + 1));
  }
  structure.residual = model.residual;
  return structure;
}

TEST(ComparedStructure, GoesByNamesOfChannels) {
  const auto structure = structure_of(table().truth);
  auto measured = modal::part(table().measured, {3, 1}, {12, 0, 5});
  measured = modal::converted(measured, modal::FrfKind::accelerance);
  const auto all = fit_of(table().truth);
  auto fit = all;
  fit.model.output_shapes = all.model.output_shapes({3, 1}, Eigen::all);
  fit.output_std = all.output_std.topRows(2);
  fit.model.input_shapes = all.model.input_shapes(Eigen::all, {12, 0, 5});
  fit.input_std = all.input_std.leftCols(3);
  const auto found = compared(structure, measured, &fit);
  EXPECT_EQ(found.responses.outputs, (std::vector<std::string>{"y4", "y2"}));
  EXPECT_LT(found.responses.overall_error, 1e-9);
  for (const auto& pair : found.modes.pairs) EXPECT_EQ(pair.simulated, pair.measured);
  measured.outputs[0].name = "elsewhere";
  EXPECT_EQ(compared(structure, measured, &fit).responses.error.rows(), 1);
  measured.outputs[1].name = "nowhere";
  EXPECT_THROW(static_cast<void>(compared(structure, measured)), InvalidInput);
  measured.outputs[1].name = "y2";
  EXPECT_THROW(static_cast<void>(compared(structure, measured, nullptr, {.low_hz = 1e5})),
               InvalidInput);
}

TEST(ComparedStructure, DashpotsCoupleTheModes) {
  auto structure = structure_of(simulators::beam5x5(quiet()).truth);
  const auto r = structure.mode_count();
  const Eigen::VectorXd at = structure.outputs.shapes.row(0);
  const Eigen::VectorXd there = structure.outputs.shapes.row(3);
  structure.dashpots = 2.0 * at * at.transpose() + 0.5 * there * there.transpose();
  structure.residual.setZero();
  const Eigen::VectorXd lines = Eigen::Vector3d(20.0, 40.0, 111.0);
  const auto found = modal::frf(reduced_model(structure), lines);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * lines(k));
    const Eigen::VectorXd omega = 2.0 * std::numbers::pi * structure.frequency_hz;
    Eigen::MatrixXcd dynamic = s * structure.dashpots.cast<std::complex<double>>();
    for (Eigen::Index m = 0; m < r; ++m) {
      dynamic(m, m) +=
          s * s + 2.0 * structure.damping_ratio(m) * omega(m) * s + omega(m) * omega(m);
    }
    const Eigen::MatrixXcd expected =
        structure.outputs.shapes *
        dynamic.lu().solve(structure.inputs.shapes.transpose().cast<std::complex<double>>());
    EXPECT_LT((found.value[static_cast<std::size_t>(k)] - expected).norm(),
              1e-10 * expected.norm());
  }
}

TEST(Compared, RefusesWhatDoesNotFit) {
  auto simulated = table().exact;
  simulated.pop_back();
  EXPECT_THROW(static_cast<void>(compared(table().measured, simulated)), InvalidInput);
  simulated = table().exact;
  simulated[3].resize(2, 2);
  EXPECT_THROW(static_cast<void>(compared(table().measured, simulated)), InvalidInput);
  auto fit = fit_of(table().truth);
  fit.model.output_shapes.conservativeResize(3, Eigen::NoChange);
  EXPECT_THROW(static_cast<void>(compared(table().truth, fit)), InvalidInput);
}

}  // namespace
}  // namespace chladni::diagnosis
