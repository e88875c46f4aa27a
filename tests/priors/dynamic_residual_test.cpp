#include "priors/dynamic_residual.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace chladni::priors {
namespace {

const Eigen::VectorXd kFrequency =
    (Eigen::VectorXd(5) << 0.0, 100.0, 200.0, 300.0, 1000.0).finished();

TEST(DynamicResidual, IsLargestForTheModesAtTheRealFrequency) {
  Eigen::Index largest = 0;
  coefficient_variances(kFrequency, 205.0).maxCoeff(&largest);
  EXPECT_EQ(largest, 2);
}

TEST(DynamicResidual, HasTheValuesOfItsFormula) {
  const DynamicResidual prior{0.1, 2.0, 1.0};
  const auto q = coefficient_variances(kFrequency, 100.0, prior);
  EXPECT_NEAR(q(0), 2.0 / 1.01, 1e-12);
  EXPECT_NEAR(q(1), 3.0 / 0.01, 1e-9);
  EXPECT_NEAR(q(2), 6.0 / 9.01, 1e-12);
}

TEST(DynamicResidual, DoesNotChangeWhenStiffnessAndFrequencyAreScaledAlike) {
  const auto q = coefficient_variances(kFrequency, 180.0, {0.1, 2.0, 1.0});
  const auto scaled = coefficient_variances(kFrequency, 180.0 * 1.5, {0.1, 2.0, 2.25});
  EXPECT_TRUE(q.isApprox(scaled, 1e-12));
}

TEST(DynamicResidual, RefusesWhatIsNotPositive) {
  EXPECT_THROW((void)coefficient_variances(kFrequency, 0.0), InvalidInput);
  EXPECT_THROW((void)coefficient_variances(kFrequency, 1.0, {0.0, 1.0, 1.0}), InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
