// How long a filter settles, and from which sample on it has.
#include <gtest/gtest.h>

#include <cmath>

#include "steps/observer/stated.h"

namespace chladni::steps {
namespace {

modal::KalmanFilter filter_with(double pole) {
  modal::KalmanFilter filter;
  filter.pole = Eigen::VectorXcd::Constant(1, pole);
  return filter;
}

TEST(Settling, IsFiveTimeConstantsOfTheSlowestPole) {
  const double settle_s = settling_time({}, filter_with(std::exp(-1e-3)), 1e-4);
  EXPECT_NEAR(settle_s, 5e3 * 1e-4, 1e-9);
  EXPECT_EQ(first_settled(0.5 - 1e-9, 1e-4), 5000);
  EXPECT_EQ(settling_time({}, filter_with(0.0), 1e-4), 0.0);
  EXPECT_EQ(first_settled(0.0, 1e-4), 0);
}

// A slowest pole at 1, which may be above it by rounding, is that of a filter that never settles.
TEST(Settling, NeverEndsForAPoleAtOne) {
  constexpr Eigen::Index kLongRecord = 1'000'000'000;
  for (const double pole : {1.0, std::nextafter(1.0, 2.0), -1.0}) {
    const double settle_s = settling_time({}, filter_with(pole), 1e-4);
    EXPECT_GT(settle_s, 1e9) << pole;
    EXPECT_GT(first_settled(settle_s, 1e-4), kLongRecord) << pole;
  }
}

TEST(Settling, MayBeStatedLongerThanAnyRecord) {
  constexpr Eigen::Index kLongRecord = 1'000'000'000;
  study::ObserverPlan plan;
  plan.settle = 1e30;
  EXPECT_GT(first_settled(settling_time(plan, filter_with(0.5), 1e-4), 1e-4), kLongRecord);
}

}  // namespace
}  // namespace chladni::steps
