// Effects of the channels on measured responses of which some lines are missing.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

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

}  // namespace
}  // namespace chladni::diagnosis
