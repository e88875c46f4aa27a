#include "diagnosis/modes/another_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

constexpr FrequencyErrors kPoor{.level = 0.06, .determined = 7.0};
constexpr FrequencyErrors kGood{.level = 0.003, .determined = 7.0};

Supposed changed(std::string_view name, double x) {
  const auto& one = effect(name);
  const auto count = one.parameters(small_plate()).size();
  Supposed supposed{&one, 0, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count))};
  supposed.x(0) = x;
  return supposed;
}

double probability(std::string_view name, double x, const FrequencyErrors& errors = kPoor) {
  return of_another_body(small_plate(), {changed(name, x)}, errors);
}

// A gain of any size is this body's. A modulus twice as high may be; three times is not.
TEST(AnotherBody, IsLikelierTheLargerTheChangesOfTheWholeBodyAre) {
  EXPECT_EQ(probability("sensor_gain", 1.2), 0.0);
  EXPECT_EQ(probability("density", 0.59), 0.0);
  EXPECT_LT(probability("youngs_modulus", std::log(2.0)), 0.1);
  EXPECT_GT(probability("youngs_modulus", std::log(3.0)), 0.99);
  EXPECT_GT(probability("youngs_modulus", -std::log(3.0)), 0.99);
  double before = 0.0;
  for (double x = 0.61; x < 1.2; x += 0.05) {
    const double now = probability("density", x);
    EXPECT_GT(now, before) << x;
    before = now;
  }
}

// Two changes, neither of which is too large alone.
TEST(AnotherBody, CountsAllChanges) {
  const auto stiff = changed("youngs_modulus", 0.8);
  const auto heavy = changed("density", 0.8);
  const double alone = of_another_body(small_plate(), {stiff}, kPoor);
  EXPECT_LT(alone, 0.5);
  EXPECT_GT(of_another_body(small_plate(), {stiff, heavy}, kPoor), 0.5);
}

// Frequencies that fit speak for this body, whatever its modulus; nothing is known of no modes.
TEST(AnotherBody, IsUnlikelyWhereTheFrequenciesFit) {
  EXPECT_LT(probability("youngs_modulus", std::log(3.0), kGood), 1e-4);
  const FrequencyErrors none{.level = 0.0, .determined = 0.0};
  EXPECT_EQ(probability("density", 1.0, none), probability("density", 1.0, kPoor));
}

TEST(AnotherBody, HasItsOwnMaterialAndDimensions) {
  int of_body = 0;
  for (const auto* one : effects()) of_body += one->is_of_body ? 1 : 0;
  EXPECT_EQ(of_body, 5);
}

}  // namespace
}  // namespace chladni::diagnosis
