#include "rotation/turn.h"

#include <fmt/format.h>

#include <array>

namespace chladni::rotation {
namespace {

DrawnSample of(unsigned number) {
  DrawnSample sample;
  sample.number = number;
  return sample;
}

TEST(Turn, ComesOnceInFourLandingsInARow) {
  for (int i = 0; i < 200; ++i) {
    const auto name = fmt::format("Rigs/RightLabels.Stay/{}", i);
    int turns = 0;
    for (const unsigned number : {46U, 47U, 48U, 49U}) turns += has_turn(name, of(number)) ? 1 : 0;
    EXPECT_EQ(turns, 1) << name;
  }
}

TEST(Turn, OfWhatIsDearComesOnceInEight) {
  for (int i = 0; i < 200; ++i) {
    const auto name = fmt::format("Readings.Name{}", i);
    int turns = 0;
    for (unsigned number = 0; number < 8; ++number) {
      auto sample = of(number % 4);
      sample.half = number / 4;
      turns += has_rare_turn(name, sample) ? 1 : 0;
      EXPECT_TRUE(has_turn(name, sample) || !has_rare_turn(name, sample)) << name;
    }
    EXPECT_EQ(turns, 1) << name;
  }
}

TEST(Turn, QuartersAreAboutAsLarge) {
  std::array<int, 4> tests{};
  for (int i = 0; i < 400; ++i) {
    for (unsigned q = 0; q < 4; ++q) {
      tests[q] += has_turn(fmt::format("DiagnosedModes.Name{}", i), of(q)) ? 1 : 0;
    }
  }
  for (const int count : tests) EXPECT_NEAR(count, 100, 45);  // five deviations of a draw
}

TEST(Turn, IsAlwaysWhereAllAreAsked) {
  DrawnSample all;
  all.all = true;
  for (const auto* name : {"A.B", "A.C", "A.D", "A.E", "A.F"}) {
    EXPECT_TRUE(has_turn(name, all));
    EXPECT_TRUE(has_rare_turn(name, all));
  }
}

TEST(Turn, SaysWhyATestIsSkipped) {
  const auto why = why_skipped();
  if (why.empty()) return;
  EXPECT_NE(why.find("CHLADNI_STUDIES=all"), std::string::npos);
}

}  // namespace
}  // namespace chladni::rotation
