// Noise and nonlinearity told apart by what they change with.
#include "diagnosis/verdict/nonlinearity.h"

#include <gtest/gtest.h>

#include <complex>

namespace chladni::diagnosis {
namespace {

// Two sensors, an actuator; responses of size 2 and 3 with the given relative deviations.
modal::FrfSet measured(double noise, double distortion, double strong_from_hz = 1e9) {
  modal::FrfSet set;
  for (const auto* name : {"s1", "s2"}) set.outputs.push_back({name, {}, {}, {}, "m"});
  set.inputs.push_back({"a1", {}, {}, {}, "N"});
  set.frequency_hz = Eigen::VectorXd::LinSpaced(80, 10.0, 800.0);
  for (Eigen::Index k = 0; k < 80; ++k) {
    const double more = set.frequency_hz(k) > strong_from_hz ? 3.0 * distortion : distortion;
    const Eigen::Vector2d power(4.0, 9.0);
    set.value.emplace_back(power.cwiseSqrt().cast<std::complex<double>>());
    set.noise_variance.emplace_back(noise * noise * power);
    set.variance.emplace_back((noise * noise + more * more) * power);
  }
  return set;
}

TEST(Nonlinearity, IsWhatNoiseDoesNotExplain) {
  const auto found = nonlinearity(measured(0.03, 0.04));
  EXPECT_NEAR(found.share, 16.0 / 25.0, 1e-12);
  EXPECT_NEAR(found.level, 0.04, 1e-12);
  EXPECT_NE(nonlinearity_note(measured(0.03, 0.04)).find("64 % of the variance"),
            std::string::npos);
}

TEST(Nonlinearity, IsPlacedWhereItIsStrongest) {
  const auto found = nonlinearity(measured(0.01, 0.01, 705.0));
  EXPECT_NEAR(found.strongest, 0.03, 1e-12);
  EXPECT_NEAR(found.strongest_hz, 755.0, 1e-9);
}

TEST(Nonlinearity, IsNotSpokenOfWhereNoiseIsTheMost) {
  EXPECT_TRUE(nonlinearity_note(measured(0.04, 0.03)).empty());
  auto silent = measured(0.01, 0.04);
  silent.noise_variance.clear();
  EXPECT_TRUE(nonlinearity_note(silent).empty());
  EXPECT_EQ(nonlinearity(silent).share, 0.0);
}

}  // namespace
}  // namespace chladni::diagnosis
