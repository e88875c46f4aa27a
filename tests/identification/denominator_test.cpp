// The two ways to a vector fit's denominator: sums of products and rows agree as far as rounding is
// said to let them.
#include "identification/poles/denominator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "identification/fit_data.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

struct Problem {
  FitData data;
  Eigen::VectorXd x;
  Eigen::VectorXcd poles;
};

Problem problem(Eigen::Index poles, double damping) {
  simulators::FrfFaults faults;
  faults.missing = 0.05;
  Problem made;
  made.data = fit_data(simulators::beam5x3(faults).measured);
  made.x = made.data.frequency_hz / made.data.frequency_hz.tail(1)(0);
  made.poles.resize(poles);
  for (Eigen::Index i = 0; i < poles; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(poles);
    made.poles(i) = at * std::complex<double>(-damping, 1.0);
  }
  return made;
}

TEST(Denominator, IsTheSameOfSumsAndOfRows) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const bool rigid : {false, true}) {
    for (const Eigen::Index poles : {1, 4, 9, 16, 30}) {
      const auto made = problem(poles, 0.01);
      PoleProducts products(made.data, made.x, rigid);
      products.set_poles(made.poles);
      const auto sums = denominator_by_sums(products);
      const auto rows = denominator_by_rows(made.data, made.x, made.poles, rigid);
      for (int repeat = 0; repeat < 20; ++repeat) {
        Eigen::VectorXd c(2 * poles + 1);
        for (auto& one : c) one = normal(random);
        const double left = c.dot(rows.left * c);
        EXPECT_NEAR(c.dot(sums.left * c), left, c.dot(sums.rounding * c) + 1e-9 * left)
            << poles << rigid;
      }
    }
  }
}

// The least of all with Σ c·φ = K: any other denominator of that sum leaves more.
TEST(Denominator, LeavesTheLeast) {
  const auto made = problem(6, 0.02);
  PoleProducts products(made.data, made.x, false);
  products.set_poles(made.poles);
  const auto rows = denominator_by_rows(made.data, made.x, made.poles, false);
  const auto sums = products.sums();
  const auto least = least_denominator(rows, sums);
  ASSERT_TRUE(least.sound());
  EXPECT_NEAR(sums.dot(least.coefficient), static_cast<double>(made.x.size()), 1e-6);
  for (Eigen::Index i = 0; i < sums.size(); ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      Eigen::VectorXd c = least.coefficient;
      c(i) += step;
      c *= sums.dot(least.coefficient) / sums.dot(c);
      EXPECT_GE(c.dot(rows.left * c), least.left * (1.0 - 1e-9)) << i;
    }
  }
}

// What rounding decides is not sound: functions that depend on each other but for their last bits.
TEST(Denominator, KnowsWhatRoundingDecides) {
  auto made = problem(6, 1e-3);
  for (Eigen::Index i = 1; i < 6; ++i) made.poles(i) = made.poles(0) * (1.0 + 1e-7 * double(i));
  PoleProducts products(made.data, made.x, false);
  products.set_poles(made.poles);
  const auto by_sums = denominator_by_sums(products);
  EXPECT_FALSE(least_denominator(by_sums, products.sums()).sound());
  const auto rows = denominator_by_rows(made.data, made.x, made.poles, false);
  EXPECT_TRUE(least_denominator(rows, products.sums()).coefficient.allFinite());
}

}  // namespace
}  // namespace chladni::identification
