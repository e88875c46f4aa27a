#include "simulators/frf_cases.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "modal/frf.h"
#include "simulators/frf_bounds.h"

namespace chladni::simulators {
namespace {

using std::numbers::pi;

FrfFaults quiet() {
  FrfFaults faults;
  faults.noisy = false;
  return faults;
}

double difference(const std::vector<Eigen::MatrixXcd>& a, const std::vector<Eigen::MatrixXcd>& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    worst = std::max(worst, (a[k] - b[k]).norm() / b[k].norm());
  }
  return worst;
}

TEST(FrfCases, AreTheResponsesOfTheirTruth) {
  auto damped = quiet();
  damped.dashpot = 0.5;
  damped.out_of_band = 0.07;
  for (const auto& made :
       {beam5x3(quiet()), oat4x13(quiet()), pairs(1e-3, 0.01, 0.01, quiet()), beam5x5(damped)}) {
    const auto known = modal::frf(made.truth, made.measured.frequency_hz);
    EXPECT_LT(difference(made.exact, known.value), 1e-10);
    EXPECT_EQ(difference(made.measured.value, made.exact), 0.0);
  }
}

TEST(FrfCases, HaveTheModesAndLinesTheyPromise) {
  const auto beam = beam5x3(quiet());
  EXPECT_EQ(beam.measured.line_count(), 799);
  EXPECT_DOUBLE_EQ(beam.measured.frequency_hz(798) - beam.measured.frequency_hz(797), 0.25);
  EXPECT_EQ(beam.collocated.size(), 3U);
  const auto oat = oat4x13(quiet());
  EXPECT_EQ(oat.measured.line_count(), 3981);
  EXPECT_EQ(oat.truth.mode_count(), 20);
  EXPECT_EQ(oat.truth.rigid_count, 3);
  EXPECT_DOUBLE_EQ(oat.truth.frequency_hz(3), 139.0);
  EXPECT_LT(oat.truth.frequency_hz(19), 2300.0);
  EXPECT_TRUE(oat.collocated.empty());
  double closest = 1.0;
  for (Eigen::Index m = 4; m < 20; ++m) {
    closest = std::min(closest, oat.truth.frequency_hz(m) / oat.truth.frequency_hz(m - 1) - 1.0);
  }
  EXPECT_GT(closest, 1e-4);
  EXPECT_LT(closest, 1e-2);
}

TEST(FrfCases, AreReciprocalAtCollocatedPairs) {
  const auto made = beam5x5(quiet());
  for (const auto& value : made.exact) {
    EXPECT_LT((value - value.transpose()).norm(), 1e-12 * value.norm());
  }
}

TEST(FrfCases, HaveTheNoiseTheyState) {
  FrfFaults faults;
  faults.relative_noise = 0.05;
  faults.floor_noise = 0.3;
  const auto made = beam5x3(faults);
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < made.exact.size(); ++k) {
    sum += ((made.measured.value[k] - made.exact[k])
                .cwiseAbs2()
                .cwiseQuotient(made.measured.variance[k]))
               .sum();
    count += static_cast<double>(made.exact[k].size());
  }
  EXPECT_NEAR(sum / count, 1.0, 4.0 / std::sqrt(count));
}

TEST(FrfCases, ShowGainsDelaysAndGapsAsTold) {
  auto faults = quiet();
  faults.output_gain = Eigen::VectorXd{{1.1, -1.0, 1.0, 0.0, 1.0}};
  faults.delay_s = 1e-4;
  faults.missing = 0.1;
  const auto plain = beam5x3(quiet());
  const auto made = beam5x3(faults);
  const double frequency = made.measured.frequency_hz(100);
  const auto turn = std::polar(1.0, -2.0 * pi * frequency * 1e-4);
  const Eigen::MatrixXcd wanted = turn * (faults.output_gain.asDiagonal() * plain.exact[100]);
  EXPECT_LT((made.exact[100] - wanted).norm(), 1e-13 * wanted.norm());
  Eigen::Index gaps = 0;
  for (const auto& value : made.measured.value) gaps += value.array().isNaN().count();
  EXPECT_NEAR(static_cast<double>(gaps) / (799.0 * 15.0), 0.1, 0.015);
  const auto some = part(made, {1, 4}, {2, 0});
  EXPECT_EQ(some.exact[5](0, 1), made.exact[5](1, 0));
  ASSERT_EQ(some.collocated.size(), 1U);
  EXPECT_EQ(some.collocated[0], (std::pair<Eigen::Index, Eigen::Index>(1, 0)));
}

TEST(FrfCases, HaveComplexModesThatSumUpToTheResponses) {
  auto faults = quiet();
  faults.dashpot = 0.8;
  const auto made = beam5x3(faults);
  const auto modes = complex_modes(made.truth);
  ASSERT_EQ(modes.pole.size(), 5);
  double most_complex = 0.0;
  for (Eigen::Index k = 0; k < 799; k += 37) {
    const std::complex<double> s(0.0, 2.0 * pi * made.measured.frequency_hz(k));
    Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(5, 3);
    for (Eigen::Index m = 0; m < 5; ++m) {
      const Eigen::MatrixXcd residue = modes.outputs.col(m) * modes.inputs.row(m);
      sum += residue / (s - modes.pole(m)) + residue.conjugate() / (s - std::conj(modes.pole(m)));
    }
    const auto& exact = made.exact[static_cast<std::size_t>(k)];
    EXPECT_LT((sum - exact).norm(), 1e-10 * exact.norm());
  }
  for (Eigen::Index m = 0; m < 5; ++m) {
    const Eigen::VectorXcd v = modes.outputs.col(m) / modes.outputs(0, m);
    most_complex = std::max(most_complex, v.imag().norm() / v.real().norm());
  }
  EXPECT_GT(most_complex, 0.05);
}

// One mode, one response: (ω, ζ, a) by differences.
TEST(FrfBounds, AreThoseOfDifferencesForOneResponse) {
  modal::ReducedModel model;
  model.frequency_hz = Eigen::VectorXd::Constant(1, 10.0);
  model.damping_ratio = Eigen::VectorXd::Constant(1, 0.02);
  model.output_shapes = Eigen::MatrixXd::Constant(1, 1, 3.0);
  model.input_shapes = Eigen::MatrixXd::Constant(1, 1, 0.5);
  model.residual = Eigen::MatrixXd::Zero(1, 1);
  const FrfGrid grid{Eigen::MatrixX3d::Zero(1, 3), Eigen::MatrixX3d::Ones(1, 3),
                     Eigen::VectorXd::LinSpaced(200, 5.0, 15.0)};
  auto faults = quiet();
  faults.floor_noise = 0.2;
  const auto made = frf_case(model, grid, faults);
  const auto bounds = cramer_rao(made, {false, false});
  Eigen::MatrixXd jacobian(400, 3);
  for (Eigen::Index c = 0; c < 3; ++c) {
    std::vector<std::vector<Eigen::MatrixXcd>> sides;
    for (const double sign : {1.0, -1.0}) {
      auto moved = model;
      if (c == 0) moved.frequency_hz(0) += sign * 1e-5;
      if (c == 1) moved.damping_ratio(0) += sign * 1e-5;
      if (c == 2) moved.output_shapes(0, 0) += sign * 1e-5;
      sides.push_back(modal::frf(moved, grid.frequency_hz).value);
    }
    for (Eigen::Index k = 0; k < 200; ++k) {
      const auto line = static_cast<std::size_t>(k);
      const std::complex<double> slope = (sides[0][line](0, 0) - sides[1][line](0, 0)) / 2e-5 *
                                         std::sqrt(2.0 / made.measured.variance[line](0, 0));
      jacobian(2 * k, c) = slope.real();
      jacobian(2 * k + 1, c) = slope.imag();
    }
  }
  const Eigen::MatrixXd covariance = (jacobian.transpose() * jacobian).inverse();
  EXPECT_EQ(bounds.parameters, 3);
  EXPECT_NEAR(bounds.frequency_hz(0), std::sqrt(covariance(0, 0)), 1e-6 * bounds.frequency_hz(0));
  EXPECT_NEAR(bounds.damping(0), std::sqrt(covariance(1, 1)), 1e-6 * bounds.damping(0));
  // With |L| / |R| held, L and R share the uncertainty of their product.
  EXPECT_NEAR(bounds.outputs(0, 0), 0.5 * std::sqrt(covariance(2, 2)), 1e-6 * bounds.outputs(0, 0));
  EXPECT_NEAR(bounds.inputs(0, 0), bounds.outputs(0, 0) * 0.5 / 3.0, 1e-6 * bounds.inputs(0, 0));
}

TEST(FrfBounds, OfARigidBodyAloneAreThoseOfItsEntries) {
  modal::ReducedModel model;
  model.rigid_count = 2;
  model.frequency_hz = model.damping_ratio = Eigen::Vector2d::Zero();
  model.output_shapes = Eigen::Matrix2d{{1.0, 2.0}, {-1.0, 4.0}};
  model.input_shapes = model.output_shapes.transpose();
  FrfGrid grid;
  grid.outputs = grid.inputs = Eigen::MatrixX3d::Identity(2, 3);
  grid.frequency_hz = Eigen::VectorXd::LinSpaced(20, 1.0, 20.0);
  const auto bounds = cramer_rao(frf_case(model, grid, quiet()), {false, false});
  EXPECT_EQ(bounds.parameters, 4);
  const Eigen::Matrix2d product = model.output_shapes * model.input_shapes;
  const Eigen::Matrix2d wanted = 0.01 * product.cwiseAbs() / std::sqrt(2.0 * 20.0);
  EXPECT_LT((bounds.rigid - wanted).norm(), 1e-9 * wanted.norm());
}

TEST(FrfBounds, FollowNoiseAndScaleAndNuisance) {
  auto faults = quiet();
  const auto one = cramer_rao(beam5x3(faults));
  faults.relative_noise *= 3.0;
  const auto three = cramer_rao(beam5x3(faults));
  EXPECT_LT((three.frequency_hz - 3.0 * one.frequency_hz).norm(), 1e-9 * three.frequency_hz.norm());
  EXPECT_LT((three.outputs - 3.0 * one.outputs).norm(), 1e-7 * three.outputs.norm());
  const auto fewer = cramer_rao(beam5x3(quiet()), {false, false});
  EXPECT_TRUE((fewer.damping.array() < one.damping.array() * (1.0 + 1e-9)).all());
  const auto more = cramer_rao(beam5x3(quiet()), {true, true});
  EXPECT_TRUE((more.frequency_hz.array() > one.frequency_hz.array() * (1.0 - 1e-9)).all());
  EXPECT_NEAR(more.delay_s, 9e-8, 6e-8);  // 90 ns at 1 %
}

TEST(FrfBounds, RefuseWhatTheyDoNotCover) {
  EXPECT_THROW((void)cramer_rao(pairs(0.0, 0.01, 0.01, quiet())), NumericalFailure);
  auto faults = quiet();
  faults.dashpot = 1.0;
  EXPECT_THROW((void)cramer_rao(beam5x3(faults)), InvalidInput);
}

}  // namespace
}  // namespace chladni::simulators
