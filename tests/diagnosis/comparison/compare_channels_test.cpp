// Effects of the channels on measured responses of which some lines are missing.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "diagnosis/compare.h"
#include "simulators/frf_cases.h"

namespace chladni::diagnosis {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// Each of two sensors lacks an eighth of the lines, at other frequencies: they are alike as far as
// both have a line. A third sensor has all lines.
TEST(ComparedChannels, AreAlikeOnTheLinesThatBothHave) {
  const auto table = simulators::oat4x13({});
  auto measured = table.measured;
  auto common = table.measured;
  const auto lines = static_cast<std::size_t>(measured.line_count());
  for (const auto& [sensor, from] : {std::pair{0, lines / 8}, std::pair{1, lines / 2}}) {
    for (std::size_t k = from; k < from + lines / 8; ++k) {
      measured.value[k].row(sensor).setConstant(kMissing);
      common.value[k].topRows(2).setConstant(kMissing);
    }
  }
  const auto own = compared(measured, table.exact).output_alike;
  const auto both = compared(common, table.exact).output_alike;
  EXPECT_NEAR(own(0, 1), both(0, 1), 1e-12);
  EXPECT_NEAR(own(1, 0), both(1, 0), 1e-12);
  EXPECT_TRUE(own.allFinite());
}

// The noise of the others is told, whichever response was not measured.
TEST(ComparedChannels, AnUnmeasuredFirstResponseHidesNoNoise) {
  const auto table = simulators::oat4x13({});
  auto measured = table.measured;
  for (std::size_t k = 0; k < measured.value.size(); ++k) {
    measured.value[k](0, 0) = kMissing;
    measured.variance[k](0, 0) = kMissing;
  }
  const auto found = compared(measured, table.exact);
  EXPECT_GT(found.overall_noise, 0.0);
  EXPECT_TRUE(std::isnan(found.noise(0, 0)));
  EXPECT_NEAR(found.noise(1, 0), compared(table.measured, table.exact).noise(1, 0), 1e-15);
}

// A channel without a number has no gain, and none of the level is taken for it.
TEST(ComparedChannels, ThatSayNothingHaveNoGain) {
  const auto table = simulators::oat4x13({});
  auto measured = modal::part(table.measured, {0, 1}, {0, 1, 2});
  std::vector<Eigen::MatrixXcd> simulated;
  for (const auto& value : table.exact)
    simulated.emplace_back(value(std::vector{0, 1}, std::vector{0, 1, 2}));
  for (std::size_t k = 0; k < measured.value.size(); ++k) {
    measured.value[k] = 2.0 * simulated[k];
    measured.value[k].row(1).setConstant(kMissing);
  }
  const auto found = compared(measured, simulated);
  EXPECT_NEAR(found.level, 2.0, 1e-12);
  EXPECT_NEAR(found.output_gain(0), 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(found.output_gain(1)));
  EXPECT_LT((found.input_gain.array() - 1.0).abs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace chladni::diagnosis
