#include "priors/gaussian_process/optimum.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace chladni::priors {
namespace {

double rosenbrock(const Eigen::VectorXd& x, Eigen::VectorXd& slope) {
  const double bend = x(1) - x(0) * x(0);
  slope(0) = -400.0 * x(0) * bend - 2.0 * (1.0 - x(0));
  slope(1) = 200.0 * bend;
  return 100.0 * bend * bend + (1.0 - x(0)) * (1.0 - x(0));
}

TEST(Optimum, IsFoundAtTheEndOfAValley) {
  const auto found = minimum(rosenbrock, Eigen::Vector2d(-1.2, 1.0), Eigen::Vector2d(-5, -5),
                             Eigen::Vector2d(5, 5));
  EXPECT_TRUE(found.converged);
  EXPECT_LT((found.at - Eigen::Vector2d(1, 1)).norm(), 1e-3);
  EXPECT_FALSE(found.at_bound[0]);
}

TEST(Optimum, SaysWhichBoundsItStandsAt) {
  const auto found = minimum(rosenbrock, Eigen::Vector2d(-1.0, 1.0), Eigen::Vector2d(-5, -5),
                             Eigen::Vector2d(0.5, 5));
  EXPECT_TRUE(found.at_bound[0]);
  EXPECT_FALSE(found.at_bound[1]);
  EXPECT_NEAR(found.at(1), 0.25, 1e-3);
}

TEST(Optimum, PassesOnWhatTheObjectiveThrows) {
  const Objective fails = [](const Eigen::VectorXd&, Eigen::VectorXd&) -> double {
    throw NumericalFailure("not positive definite");
  };
  EXPECT_THROW(
      (void)minimum(fails, Eigen::Vector2d(0, 0), Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, 1)),
      NumericalFailure);
}

TEST(Optimum, RefusesAStartOutsideItsBox) {
  EXPECT_THROW((void)minimum(rosenbrock, Eigen::Vector2d(9, 0), Eigen::Vector2d(-1, -1),
                             Eigen::Vector2d(1, 1)),
               InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
