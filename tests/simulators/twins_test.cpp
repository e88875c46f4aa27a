#include "simulators/twins.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chladni::simulators {
namespace {

HiddenCase late(double severity) {
  HiddenOptions options;
  options.lines = 40;
  options.degree = 8;
  options.severity = severity;
  return hidden_case({"sensor_delay"}, 3, options);
}

// |e^{-x} (1 + x) - 1| is x²/2 to leading order. Four times the delay gives 256 times the distance.
TEST(Twins, PartAsTheFourthPowerOfADelay) {
  const auto small = late(0.0);
  const auto large = late(std::log(4.0) / std::log(400.0));
  ASSERT_NEAR(large.truth[0].size.at("delay"), 4.0 * small.truth[0].size.at("delay"), 1e-12);
  EXPECT_NEAR(evidence_apart(large) / evidence_apart(small), 256.0, 15.0);
  EXPECT_LT(evidence_apart(small), 0.01);
  EXPECT_GT(evidence_apart(late(1.0)), 1e3);
}

TEST(Twins, AreNoneOfAMass) {
  HiddenOptions options;
  options.lines = 40;
  options.degree = 8;
  EXPECT_TRUE(std::isinf(evidence_apart(hidden_case({"point_mass"}, 3, options))));
}

}  // namespace
}  // namespace chladni::simulators
