// Ctrl-C is heard wherever lengths are learned or fields are predicted.
#include "base/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>

#include "base/error.h"
#include "priors/learning.h"

namespace chladni::priors {
namespace {

Points on_a_line(Eigen::Index count) {
  Points points = Points::Zero(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) points(i, 0) = 0.1 * static_cast<double>(i);
  return points;
}

class PriorsInterrupt : public testing::Test {
 protected:
  void SetUp() override {
    catch_interrupts();
    ASSERT_EQ(std::raise(SIGINT), 0);
  }
  void TearDown() override { forget_interrupt(); }
};

TEST_F(PriorsInterrupt, IsHeardWhileLearning) {
  const Points points = on_a_line(6);
  const Eigen::MatrixXd values = points.col(0).array().sin();
  const Kernel one(kernel_family("matern_5_2"));
  EXPECT_THROW(static_cast<void>(learned(one, points, values, {})), Interrupted);
  const Kernel several(kernel_family("rational_quadratic"));
  EXPECT_THROW(static_cast<void>(learned(several, points, values, {})), Interrupted);
}

TEST_F(PriorsInterrupt, IsHeardWhileLengthsAreMatched) {
  Task task;
  task.places = on_a_line(3);
  task.surface = on_a_line(6);
  task.area = Eigen::VectorXd::Ones(6);
  task.at_places = task.places.col(0).array().cos();
  task.on_surface = task.surface.col(0).array().cos();
  const Kernel kernel(kernel_family("matern_5_2"));
  EXPECT_THROW(static_cast<void>(matched_length(kernel, task)), Interrupted);
  EXPECT_THROW(static_cast<void>(expected_length(kernel, task)), Interrupted);
}

TEST_F(PriorsInterrupt, IsHeardBySlopes) {
  const Points points = on_a_line(6);
  const Kernel kernel(kernel_family("matern_5_2"));
  const Eigen::VectorXd length = Eigen::VectorXd::Constant(1, 0.2);
  const Eigen::MatrixXd weights = Eigen::MatrixXd::Identity(6, 6);
  EXPECT_THROW(static_cast<void>(contractions(kernel, length, points, weights, points)),
               Interrupted);
}

}  // namespace
}  // namespace chladni::priors
