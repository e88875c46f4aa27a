#include "priors/polynomial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/draw.h"
#include "base/error.h"

namespace chladni::priors {
namespace {

Eigen::MatrixX2d scattered(Eigen::Index count) {
  Draw draw(2);
  Eigen::MatrixX2d at(count, 2);
  for (double& x : at.reshaped()) x = 0.3 + 0.6 * draw.uniform();
  return at;
}

Eigen::MatrixXd shapes_of(const Eigen::MatrixX2d& at) {
  Eigen::MatrixXd shapes(at.rows(), 2);
  const auto x = at.col(0).array();
  const auto y = at.col(1).array();
  shapes.col(0) = (1.0 + 2.0 * x - y + 3.0 * x * y * y).matrix();
  shapes.col(1) = (9.0 * x).sin().matrix();
  return shapes;
}

TEST(Polynomial, ReproducesPolynomialsOfItsDegree) {
  const auto at = scattered(200);
  const auto fitted = polynomials(at, Eigen::VectorXd::Ones(200), shapes_of(at), 3);
  EXPECT_LT(fitted.largest_error(0), 1e-12);
  EXPECT_LT((values(fitted, at).col(0) - shapes_of(at).col(0)).norm(), 1e-11);
  EXPECT_GT(fitted.rms_error(1), 1e-3);
}

TEST(Polynomial, ComesNearerWithEachDegreeAndSaysHowNear) {
  const auto at = scattered(500);
  double last = 2.0;
  for (const int degree : {2, 4, 6, 8}) {
    const auto fitted = polynomials(at, Eigen::VectorXd::Ones(500), shapes_of(at), degree);
    EXPECT_LT(fitted.rms_error(1), 0.3 * last);
    const auto wrong = (values(fitted, at) - shapes_of(at)).col(1).eval();
    EXPECT_NEAR(fitted.rms_error(1), wrong.norm() / shapes_of(at).col(1).norm(), 1e-10);
    last = fitted.rms_error(1);
  }
}

TEST(Polynomial, RefusesTooFewPointsAndPointsOnALine) {
  const auto at = scattered(5);
  EXPECT_THROW((void)polynomials(at, Eigen::VectorXd::Ones(5), shapes_of(at), 2), InvalidInput);
  Eigen::MatrixX2d line = scattered(50);
  line.col(1).setZero();
  EXPECT_THROW((void)polynomials(line, Eigen::VectorXd::Ones(50), shapes_of(line), 2),
               InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
