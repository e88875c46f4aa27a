// Tolerances and the levels that data show.
#include "diagnosis/learned_levels.h"

#include <gtest/gtest.h>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

ErrorLevel level(const char* of, double value, double determined) {
  return {.of = of, .value = value, .usual = 3e-3, .at_most = 0.1, .determined = determined};
}

TEST(LearnedLevels, TakeThePlaceOfSmallerTolerances) {
  const Tolerances stated;
  const auto learned =
      with_levels(stated, {level("frequency", 0.02, 8.0), level("gain", 1e-4, 8.0)});
  EXPECT_EQ(learned.frequency, 0.02);
  EXPECT_EQ(learned.gain, stated.gain);
  EXPECT_EQ(learned.response, stated.response);
}

TEST(LearnedLevels, AreBeyondTolerancesWhereEnoughErrorsShowIt) {
  const Tolerances stated;
  const double far = 1.01 * kConstants.beyond_tolerance * stated.frequency;
  EXPECT_FALSE(are_beyond(stated, {}));
  EXPECT_TRUE(are_beyond(stated, {level("frequency", far, 5.0)}));
  EXPECT_FALSE(are_beyond(stated, {level("frequency", 0.9 * far, 5.0)}));
  EXPECT_FALSE(are_beyond(stated, {level("frequency", far, 2.0)}));  // mostly its prior
  EXPECT_FALSE(are_beyond(stated, {level("damping", far, 5.0)}));
  const double off = 1.01 * kConstants.beyond_response * stated.response;
  EXPECT_TRUE(are_beyond(stated, {level("shape", off, 5.0)}));
  EXPECT_TRUE(are_beyond(stated, {level("smooth_shape", off, 5.0)}));
}

// Whoever states that the model is so good as the data say is not told that it is less good.
TEST(LearnedLevels, AreNotBeyondTolerancesThatHaveThem) {
  const std::vector<ErrorLevel> levels{level("frequency", 0.02, 8.0), level("shape", 0.06, 60.0)};
  EXPECT_TRUE(are_beyond({}, levels));
  EXPECT_FALSE(are_beyond(with_levels({}, levels), levels));
}

}  // namespace
}  // namespace chladni::diagnosis
