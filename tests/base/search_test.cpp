#include "base/search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"

namespace chladni {
namespace {

// (x − 2)² + 3 and its slope.
double bowl(double x) { return (x - 2.0) * (x - 2.0) + 3.0; }
double slope_of_bowl(double x) { return 2.0 * (x - 2.0); }

// Valleys near each 2π n; that near 2π is the lowest one.
double waves(double x) { return 0.01 * (x - 6.0) * (x - 6.0) - std::cos(x); }
double slope_of_waves(double x) { return 0.02 * (x - 6.0) + std::sin(x); }

TEST(Search, FindsTheBottomOfAParabola) {
  const auto found = minimum_in(bowl, -5.0, 7.0);
  EXPECT_NEAR(found.at, 2.0, 1e-7);
  EXPECT_DOUBLE_EQ(found.value, 3.0);
  EXPECT_LE(found.evaluations, 15);
}

TEST(Search, FindsTheBottomOfACuspWithFewEvaluations) {
  int calls = 0;
  const auto found =
      minimum_in([&](double x) { return ++calls, std::sqrt(std::abs(x - 0.3)); }, -1.0, 2.0);
  EXPECT_NEAR(found.at, 0.3, 1e-7);
  EXPECT_LE(calls, 60);
  EXPECT_EQ(found.evaluations, calls);
}

TEST(Search, FindsTheLowestOfSeveralValleys) {
  const auto found = minimum_in(waves, -20.0, 20.0, 80);
  EXPECT_NEAR(slope_of_waves(found.at), 0.0, 1e-6);
  EXPECT_NEAR(found.at, 2.0 * std::numbers::pi, 0.1);
  EXPECT_FALSE(found.at_low || found.at_high);
}

TEST(Search, FindsTheRootOfTheSlopeToRounding) {
  int calls = 0;
  const auto counted = [&](const auto& f) { return [&](double x) { return ++calls, f(x); }; };
  const auto found = minimum_in(counted(waves), counted(slope_of_waves), -20.0, 20.0, 80);
  EXPECT_NEAR(slope_of_waves(found.at), 0.0, 2e-15);
  EXPECT_DOUBLE_EQ(found.value, waves(found.at));
  EXPECT_EQ(found.evaluations, calls);
  EXPECT_LE(calls, 81 + 20);
}

TEST(Search, IsTheSameForAShiftedAndScaledFunction) {
  const auto found = minimum_in(waves, -20.0, 20.0, 80);
  const auto scaled = [](double x) { return 1e6 * waves((x - 3.0) / 5.0); };
  EXPECT_NEAR(minimum_in(scaled, -97.0, 103.0, 80).at, 3.0 + 5.0 * found.at, 1e-5);
}

TEST(Search, SaysThatTheMinimumIsAtAnEnd) {
  const auto low = minimum_in(bowl, slope_of_bowl, 2.5, 7.0, 9);
  EXPECT_TRUE(low.at_low);
  EXPECT_FALSE(low.at_high);
  EXPECT_DOUBLE_EQ(low.at, 2.5);
  const auto high = minimum_in(bowl, -7.0, 1.0, 9);
  EXPECT_TRUE(high.at_high);
  EXPECT_DOUBLE_EQ(high.at, 1.0);
}

TEST(Search, TakesTheFirstOfEqualPointsAndSkipsThoseThatAreNotANumber) {
  const auto flat = lowest_of_scan([](double) { return 1.0; }, 0.0, 1.0, 4);
  EXPECT_DOUBLE_EQ(flat.at, 0.0);
  EXPECT_EQ(flat.evaluations, 5);
  const auto part = [](double x) { return x < 0.5 ? std::nan("") : x; };
  EXPECT_DOUBLE_EQ(lowest_of_scan(part, 0.0, 1.0, 4).at, 0.5);
  EXPECT_THROW((void)lowest_of_scan([](double) { return std::nan(""); }, 0.0, 1.0, 4),
               NumericalFailure);
}

TEST(Search, FindsRootsToRounding) {
  int calls = 0;
  const auto counted = [&](double x) { return ++calls, std::cos(x) - x; };
  EXPECT_NEAR(root_in(counted, 0.0, 1.0), 0.7390851332151607, 1e-15);
  EXPECT_LE(calls, 15);
  EXPECT_NEAR(root_in([](double x) { return std::cbrt(x - 0.1); }, -1.0, 1.0), 0.1, 1e-15);
  EXPECT_NEAR(root_in([](double x) { return 1.0 - std::exp(x); }, -3.0, 700.0), 0.0, 1e-15);
}

TEST(Search, TakesAnEndThatIsARoot) {
  EXPECT_EQ(root_in(slope_of_bowl, 2.0, 3.0), 2.0);
  EXPECT_EQ(root_in(slope_of_bowl, 1.0, 2.0), 2.0);
}

TEST(Search, RefusesWhatItCannotSearch) {
  EXPECT_THROW((void)root_in(slope_of_bowl, 3.0, 4.0), InvalidInput);
  EXPECT_THROW((void)root_in([](double) { return std::nan(""); }, 3.0, 4.0), InvalidInput);
  EXPECT_THROW((void)root_in(slope_of_bowl, 4.0, 1.0), InvalidInput);
  EXPECT_THROW((void)minimum_in(bowl, 1.0, 1.0), InvalidInput);
  EXPECT_THROW((void)minimum_in(bowl, 0.0, std::numeric_limits<double>::quiet_NaN()), InvalidInput);
  EXPECT_THROW((void)minimum_in(bowl, 0.0, 1.0, 0), InvalidInput);
}

TEST(Integral, IsExactForPolynomialsAndCloseForASine) {
  const auto power = [](double x) { return std::pow(x, 29) + 3.0 * x * x; };
  EXPECT_NEAR(integral_of(power, -1.0, 2.0), (std::pow(2.0, 30) - 1.0) / 30.0 + 9.0, 1e-6);
  EXPECT_NEAR(integral_of([](double x) { return std::sin(x); }, 0.0, 3.0), 1.0 - std::cos(3.0),
              1e-14);
  EXPECT_EQ(integral_of([](double) { return 1.0; }, 2.0, 2.0), 0.0);
}

}  // namespace
}  // namespace chladni
