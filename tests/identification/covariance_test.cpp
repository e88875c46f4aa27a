// The inverse of normal equations that are not regular.
#include "identification/likelihood/uncertainty/covariance.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "base/error.h"

namespace chladni::identification {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// One mode of one response: left, right, stiffness, damping.
BlockModel one_mode() {
  BlockModel model;
  const auto number = [](double value) { return MatrixXd::Constant(1, 1, value); };
  model.blocks = {{number(1.0), number(1.0), number(0.25), number(0.01), false}};
  return model;
}

// Normal equations whose left and right are coupled like this; the other two are told.
NormalEquations equations(const Matrix2d& of_shapes) {
  MatrixXd matrix = 4.0 * MatrixXd::Identity(4, 4);
  matrix.topLeftCorner<2, 2>() = of_shapes;
  return {matrix, Eigen::VectorXd::Zero(4)};
}

Covariance inverse(const Matrix2d& of_shapes, const MatrixXd& idle = MatrixXd(4, 0)) {
  return held_inverse(one_mode(), equations(of_shapes), idle);
}

Matrix2d two_by_two(double diagonal, double beside) {
  Matrix2d matrix = Matrix2d::Constant(beside);
  matrix.diagonal().setConstant(diagonal);
  return matrix;
}

// No data determine left and right, and the two others are as good as if they were not there.
void expect_only_the_others_known(const Covariance& found) {
  for (const Eigen::Index i : {0, 1}) {
    EXPECT_TRUE(found.unknown(i)) << i;
    EXPECT_EQ(found.matrix.row(i).norm() + found.matrix.col(i).norm(), 0.0) << i;
  }
  for (const Eigen::Index i : {2, 3}) {
    EXPECT_FALSE(found.unknown(i)) << i;
    EXPECT_NEAR(found.matrix(i, i), 0.25, 1e-14) << i;
  }
}

TEST(HeldInverse, OfRegularEquationsIsTheInverse) {
  const auto found = inverse(two_by_two(2.0, 1.0));
  EXPECT_FALSE(found.unknown.any());
  EXPECT_LT((found.matrix.topLeftCorner<2, 2>() - two_by_two(2.0, 1.0).inverse()).norm(), 1e-14);
}

TEST(HeldInverse, OfEquationsThatAreNotFiniteIsRefused) {
  try {
    (void)inverse(two_by_two(2.0, kNan));
    FAIL() << "no error";
  } catch (const NumericalFailure& e) {
    EXPECT_NE(std::string(e.what()).find("covariance of a fit"), std::string::npos) << e.what();
  }
}

// A parameter with a sum that is not finite has no variance; it does not spoil those of the others.
TEST(HeldInverse, LeavesOutParametersWhoseOwnSumsAreNotFinite) {
  expect_only_the_others_known(inverse(two_by_two(kNan, kNan)));
}

TEST(HeldInverse, OfSingularEquationsHasUnknownParameters) {
  expect_only_the_others_known(inverse(two_by_two(1.0, 1.0)));
}

TEST(HeldInverse, OfIndefiniteEquationsHasNoNegativeVariance) {
  expect_only_the_others_known(inverse(two_by_two(1.0, 2.0)));
}

// Left times and right over a factor change no response: what is held still is known.
TEST(HeldInverse, KeepsIdleDirectionsStill) {
  MatrixXd idle(4, 1);
  idle << 1.0, -1.0, 0.0, 0.0;
  const auto found = inverse(two_by_two(1.0, 1.0), idle);
  EXPECT_FALSE(found.unknown.any());
  EXPECT_LT((found.matrix.topLeftCorner<2, 2>() - two_by_two(0.25, 0.25)).norm(), 1e-14);
}

}  // namespace
}  // namespace chladni::identification
