#include "recordings/excitation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "base/error.h"
#include "recordings/fft.h"

namespace chladni::recordings {
namespace {

MultisinePlan plan_of_256() {
  MultisinePlan plan;
  plan.period = 256;
  plan.sample_time_s = 1.0 / 256.0;  // lines at whole hertz
  plan.low_hz = 3.0;
  plan.high_hz = 100.0;
  plan.rms = 2.5;
  return plan;
}

double rms(const Eigen::VectorXd& x) { return x.norm() / std::sqrt(static_cast<double>(x.size())); }

TEST(Multisine, ExcitesItsLinesAndNothingElse) {
  Draw draw(1);
  const auto found = multisine(plan_of_256(), draw);
  ASSERT_EQ(found.lines.size(), 98U);
  EXPECT_EQ(found.lines.front(), 3);
  EXPECT_EQ(found.lines.back(), 100);
  EXPECT_NEAR(rms(found.signal), 2.5, 1e-12);
  const Eigen::VectorXd magnitude = fourier(found.signal).cwiseAbs();
  const double wanted = 256.0 * 2.5 / std::sqrt(2.0 * 98.0);
  for (Eigen::Index k = 0; k < magnitude.size(); ++k) {
    EXPECT_NEAR(magnitude(k), k >= 3 && k <= 100 ? wanted : 0.0, 1e-10) << k;
  }
}

TEST(Multisine, LeavesOutOneOddLineOfFourToDetectNonlinearity) {
  auto plan = plan_of_256();
  plan.lines = ExcitedLines::odd_with_detection;
  Draw draw(2);
  const auto found = multisine(plan, draw);
  EXPECT_EQ(found.lines.size() + found.detection.size(), 98U);
  const std::set<Eigen::Index> excited(found.lines.begin(), found.lines.end());
  for (Eigen::Index group = 0; group < 12; ++group) {
    int count = 0;
    for (Eigen::Index i = 0; i < 4; ++i)
      count += static_cast<int>(excited.count(3 + 8 * group + 2 * i));
    EXPECT_EQ(count, 3) << "odd lines from " << 3 + 8 * group;
  }
  for (const auto k : found.lines) EXPECT_EQ(k % 2, 1);
}

TEST(Multisine, FollowsAShapeAndStillHasItsRms) {
  auto plan = plan_of_256();
  plan.shape_hz = Eigen::Vector2d(10.0, 40.0);
  plan.shape = Eigen::Vector2d(1.0, 100.0);
  Draw draw(3);
  const auto found = multisine(plan, draw);
  EXPECT_NEAR(rms(found.signal), 2.5, 1e-12);
  const auto at = [&](Eigen::Index k) { return std::abs(found.coefficient(k - 3)); };
  EXPECT_NEAR(at(40) / at(10), 100.0, 1e-9);
  EXPECT_NEAR(at(25) / at(10), 10.0, 1e-9);
  EXPECT_NEAR(at(90) / at(40), 1.0, 1e-9);
}

TEST(Multisine, DrawsUniformPhasesAnewAndTheSameFromTheSameSeed) {
  Draw first(7);
  Draw second(7);
  const auto a = multisine(plan_of_256(), first);
  const auto b = multisine(plan_of_256(), second);
  const auto c = multisine(plan_of_256(), first);
  EXPECT_EQ(a.signal, b.signal);
  EXPECT_GT((a.signal - c.signal).norm(), 0.1 * a.signal.norm());
  std::complex<double> mean = 0.0;
  int count = 0;
  for (int i = 0; i < 100; ++i) {
    for (const auto& x : multisine(plan_of_256(), first).coefficient) {
      mean += x / std::abs(x);
      ++count;
    }
  }
  EXPECT_LT(std::abs(mean) / count, 4.0 / std::sqrt(count));
}

TEST(Multisine, KnowsTheCrestFactorOfKnownSignals) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(1024, 0.0, 1023.0 / 1024.0);
  const Eigen::VectorXd sine = (2.0 * std::numbers::pi * 4.0 * t).array().sin();
  EXPECT_NEAR(crest_factor(sine), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(crest_factor(Eigen::VectorXd::Constant(5, -3.0)), 1.0, 1e-15);
  EXPECT_EQ(crest_factor(Eigen::VectorXd::Zero(5)), 0.0);
}

TEST(Multisine, LowersItsCrestFactorAndKeepsItsAmplitudes) {
  auto plan = plan_of_256();
  plan.period = 2048;
  plan.sample_time_s = 1.0 / 2048.0;
  Draw draw(5);
  Draw same(5);
  const auto random = multisine(plan, draw);
  plan.crest_iterations = 200;
  const auto low = multisine(plan, same);
  EXPECT_GT(random.crest_factor, 2.3);
  EXPECT_LT(low.crest_factor, 1.75);
  EXPECT_LT((low.coefficient.cwiseAbs() - random.coefficient.cwiseAbs()).norm(),
            1e-9 * random.coefficient.norm());
  EXPECT_NEAR(crest_factor(low.signal), low.crest_factor, 1e-15);
}

TEST(Multisine, OrthogonalExperimentsAreOrthogonalOnEachLine) {
  for (const Eigen::Index q : {1, 2, 3, 4, 5}) {
    Draw draw(11);
    const auto set = experiments(plan_of_256(), q, InputScheme::orthogonal, draw);
    std::vector<Eigen::MatrixXcd> spectra;
    for (const auto& inputs : set.inputs) spectra.push_back(fourier(inputs));
    for (const auto k : set.lines) {
      Eigen::MatrixXcd u(q, q);
      for (Eigen::Index e = 0; e < q; ++e) {
        u.col(e) = spectra[static_cast<std::size_t>(e)].row(k).transpose();
      }
      const Eigen::MatrixXcd product = u * u.adjoint();
      const double power = std::norm(u(0, 0)) * static_cast<double>(q);
      EXPECT_LT((product - power * Eigen::MatrixXcd::Identity(q, q)).norm(), 1e-9 * power);
    }
    for (const auto& inputs : set.inputs) {
      for (Eigen::Index j = 0; j < q; ++j) EXPECT_NEAR(rms(inputs.col(j)), 2.5, 1e-12);
    }
  }
}

TEST(Multisine, OneAtATimeLeavesTheOthersAtRest) {
  Draw draw(12);
  const auto set = experiments(plan_of_256(), 3, InputScheme::one_at_a_time, draw);
  for (Eigen::Index e = 0; e < 3; ++e) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      EXPECT_NEAR(rms(set.inputs[static_cast<std::size_t>(e)].col(j)), e == j ? 2.5 : 0.0, 1e-12);
    }
  }
}

TEST(Multisine, RefusesBandsWithoutLinesOrBeyondHalfTheSamplingFrequency) {
  Draw draw(1);
  auto plan = plan_of_256();
  plan.high_hz = 129.0;
  EXPECT_THROW((void)multisine(plan, draw), InvalidInput);
  plan = plan_of_256();
  plan.low_hz = 10.2;
  plan.high_hz = 10.8;
  EXPECT_THROW((void)multisine(plan, draw), InvalidInput);
  plan = plan_of_256();
  plan.rms = 0.0;
  EXPECT_THROW((void)multisine(plan, draw), InvalidInput);
}

}  // namespace
}  // namespace chladni::recordings
