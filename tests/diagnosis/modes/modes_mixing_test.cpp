// Modes within each other's bandwidth, which damping turns into complex ones.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/loaded_plate.h"
#include "diagnosis/modes/errors/mixing_modes.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

constexpr Complex kJ{0.0, 1.0};

// Part of the second mode in the first complex mode of two modes of unit mass that a damper
// couples.
Complex part_of_neighbour(double first_hz, double second_hz, const Eigen::Vector2d& ratio,
                          double coupling) {
  const Eigen::Vector2d omega = 2.0 * std::numbers::pi * Eigen::Vector2d(first_hz, second_hz);
  Matrix2d damping = (2.0 * ratio.cwiseProduct(omega)).asDiagonal();
  damping(0, 1) = damping(1, 0) = coupling * std::sqrt(damping(0, 0) * damping(1, 1));
  MatrixXd first_order = MatrixXd::Zero(4, 4);
  first_order.topRightCorner(2, 2).setIdentity();
  first_order.bottomLeftCorner(2, 2) = -MatrixXd(omega.cwiseAbs2().asDiagonal());
  first_order.bottomRightCorner(2, 2) = -damping;
  const Eigen::EigenSolver<MatrixXd> modes(first_order);
  Index nearest = 0;
  (modes.eigenvalues().array() - kJ * omega(0)).abs().minCoeff(&nearest);
  const Eigen::VectorXcd shape = modes.eigenvectors().col(nearest);
  return shape(1) / shape(0);
}

// Two measured modes at these frequencies, which are those of the model.
struct TwoModes {
  MeasuredModes measured;
  RecordedModes model;
  Matching matching{{0, 1}, {{0}, {1}}};
};
TwoModes two_modes(double first_hz, double second_hz, const Eigen::Vector2d& ratio) {
  TwoModes two;
  two.measured.frequency_hz = two.model.frequency_hz = Eigen::Vector2d(first_hz, second_hz);
  two.measured.damping_ratio = two.model.damping_ratio = ratio;
  return two;
}

TEST(MixingModes, HaveThePartsThatADamperGivesThem) {
  for (const double gap : {0.01, 0.02, 0.04}) {
    for (const auto& ratio : {Eigen::Vector2d(5e-4, 5e-4), Eigen::Vector2d(2e-3, 2e-3),
                              Eigen::Vector2d(1e-3, 4e-3), Eigen::Vector2d(1e-3, 3e-2)}) {
      const auto exact =
          part_of_neighbour(200.0, 200.0 * (1.0 + gap), ratio, kConstants.damping_coupling);
      const auto two = two_modes(200.0, 200.0 * (1.0 + gap), ratio);
      const auto found = mixed_by_damping(two.measured, two.model, two.matching, 0);
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found.front().mode, 1);
      const double gap_of_poles = std::hypot(std::log(1.0 + gap), ratio(1) - ratio(0));
      const double part = found.front().part / (1.0 - gap_of_poles / kConstants.nearby);
      EXPECT_NEAR(part, std::abs(exact), 0.1 * std::abs(exact)) << gap << " " << ratio.transpose();
    }
  }
}

TEST(MixingModes, HaveWholePartsInOneAnotherAndNoneFarAway) {
  const auto part = [](double second_hz) {
    const auto two = two_modes(200.0, second_hz, {5e-3, 5e-3});
    const auto found = mixed_by_damping(two.measured, two.model, two.matching, 0);
    return found.empty() ? 0.0 : found.front().part;
  };
  EXPECT_EQ(part(200.0), 1.0);
  EXPECT_EQ(part(240.0), 0.0);
  EXPECT_LT(part(231.0), 0.01) << "no step at the end";
}

TEST(MixingModes, AreThoseOfMeasuredModesWithAPartner) {
  auto two = two_modes(200.0, 200.1, {5e-3, 5e-3});
  two.measured.damping_ratio.setConstant(std::nan(""));
  EXPECT_NEAR(mixed_by_damping(two.measured, two.model, two.matching, 0).front().part, 1.0, 0.02)
      << "the damping of the model, where none was measured";
  two.matching.model[1] = -1;
  EXPECT_TRUE(mixed_by_damping(two.measured, two.model, two.matching, 0).empty());
}

// Two modes of the plate, measured `gap` apart, each with a part of the other that is a quarter of
// a period late, so that the residues stay those of complex modes: vᵀ M v is 1.
MeasuredModes mixed(const RecordedModes& model, Index k, double gap, double part) {
  auto measured = measured_of(model, 0.0);
  measured.scaled = true;
  measured.frequency_hz(k + 1) = measured.frequency_hz(k) * (1.0 + gap);
  const double rest = std::sqrt(1.0 + part * part);
  for (auto* shapes : {&measured.output_shapes, &measured.input_shapes}) {
    const MatrixXcd both = shapes->middleCols(k, 2);
    shapes->col(k) = rest * both.col(0) + kJ * part * both.col(1);
    shapes->col(k + 1) = rest * both.col(1) - kJ * part * both.col(0);
  }
  return measured;
}

double misfit(const MeasuredModes& measured, const RecordedModes& model) {
  Matching matching = matched_by_shape(measured, model);
  for (Index i = 0; i < measured.count(); ++i) {
    matching.model[at(i)] = i;
    matching.span[at(i)] = span_of(measured, model, i, i);
  }
  return LevelLikelihood(errors_of(measured, model, matching),
                         level_prior(Tolerances{}, true).usual)
      .negative_log();
}

TEST(MixingModes, OfOneFrequencyAreNoErrorOfTheModel) {
  const auto model = modes_of(loaded());
  for (const Index k : {3, 5}) {
    const double real = misfit(mixed(model, k, 2e-4, 0.0), model);
    EXPECT_LT(misfit(mixed(model, k, 2e-4, 0.4), model) - real, 5.0) << k;
    const double far = misfit(mixed(model, k, 0.3, 0.0), model);
    EXPECT_GT(misfit(mixed(model, k, 0.3, 0.4), model) - far, 30.0)
        << k << ": no damping mixes modes that lie far apart";
  }
}

// A spring too soft to be seen picks one basis of a repeated mode; it was told by 22 in ln
// evidence.
TEST(MixingModes, DoNotDependOnHowRepeatedModesAreTurned) {
  const auto model = modes_of(state_of(small_plate()));
  const auto& hz = model.frequency_hz;
  Index k = 0;
  while (hz(k + 1) - hz(k) > 1e-6 * hz(k)) ++k;
  ASSERT_LT(k + 1, kModes);
  const auto measured = measured_of(model, 0.01);
  const double expected = misfit(measured, model);
  for (const double angle : {0.3, 0.8, 1.5}) {
    auto other = model;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    for (auto* rows : {&other.outputs, &other.inputs, &other.motion}) {
      rows->middleCols(k, 2) *= (Matrix2d() << c, -s, s, c).finished();
    }
    EXPECT_NEAR(misfit(measured, other), expected, 0.01) << angle;
  }
}

}  // namespace
}  // namespace chladni::diagnosis
