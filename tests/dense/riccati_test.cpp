#include "dense/riccati.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/draw.h"
#include "base/error.h"
#include "tests/refusal.h"

namespace chladni::dense {
namespace {

Eigen::MatrixXd drawn(Draw& draw, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd m(rows, columns);
  for (double& entry : m.reshaped()) entry = draw.normal();
  return m;
}

// Stable, of spectral radius 0.98.
NoisySystem drawn_system(unsigned seed, Eigen::Index n, Eigen::Index p) {
  Draw draw(seed);
  NoisySystem system;
  system.a = drawn(draw, n, n);
  system.a *= 0.98 / system.a.eigenvalues().cwiseAbs().maxCoeff();
  system.c = drawn(draw, p, n);
  const Eigen::MatrixXd moved = drawn(draw, n, 3);
  const Eigen::MatrixXd through = drawn(draw, p, 3);
  system.q = moved * moved.transpose();
  system.r = through * through.transpose() + Eigen::MatrixXd::Identity(p, p);
  system.s = moved * through.transpose();
  return system;
}

Eigen::MatrixXd stepped(const NoisySystem& s, const Eigen::MatrixXd& p) {
  const Eigen::MatrixXd cross = s.a * p * s.c.transpose() + s.s;
  const Eigen::MatrixXd next =
      s.a * p * s.a.transpose() + s.q -
      cross * (s.c * p * s.c.transpose() + s.r).inverse() * cross.transpose();
  return 0.5 * (next + next.transpose());  // else rounding grows without bound
}

TEST(Riccati, SolvesItsEquationAndIsTheLimitOfItsSteps) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto system = drawn_system(seed, 3 + seed % 7, 1 + seed % 3);
    const auto p = prediction_covariance(system);
    EXPECT_LT((stepped(system, p) - p).norm(), 1e-11 * p.norm()) << seed;
    Eigen::MatrixXd limit = Eigen::MatrixXd::Zero(p.rows(), p.cols());
    for (int k = 0; k < 5000; ++k) limit = stepped(system, limit);
    EXPECT_LT((limit - p).norm(), 1e-9 * p.norm()) << seed;
  }
}

// p = a² p r / (p + r) + q: p² + p (r (1 − a²) − q) − q r = 0.
TEST(Riccati, OfOneStateHasAClosedForm) {
  for (const double a : {0.0, 0.5, 0.999, 1.0, 1.3}) {
    for (const double q : {1e-24, 1e-6, 1.0, 1e9}) {
      const double r = 2.5e-18;
      const auto one = [](double x) { return Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, x)); };
      const auto p = prediction_covariance({one(a), one(1.0), one(q), one(r), one(0.0)});
      const double half = 0.5 * (q - r * (1.0 - a * a));
      // The form without cancellation.
      const double root = std::sqrt(half * half + q * r);
      const double expected = half > 0.0 ? half + root : q * r / (root - half);
      EXPECT_NEAR(p(0, 0), expected, 1e-9 * expected) << a << " " << q;
    }
  }
}

// x = T x': P = T P' Tᵀ, however different the units are.
TEST(Riccati, HasNoUnits) {
  const auto system = drawn_system(3, 6, 2);
  const auto p = prediction_covariance(system);
  Eigen::VectorXd t(6);
  t << 1e-9, 1e3, 1.0, 1e-5, 1e6, 1e-12;
  const Eigen::VectorXd inverse = t.cwiseInverse();
  const auto other = prediction_covariance(
      {t.asDiagonal() * system.a * inverse.asDiagonal(), system.c * inverse.asDiagonal(),
       t.asDiagonal() * system.q * t.asDiagonal(), system.r, t.asDiagonal() * system.s});
  const Eigen::MatrixXd back = inverse.asDiagonal() * other * inverse.asDiagonal();
  EXPECT_LT((back - p).norm(), 1e-9 * p.norm());
}

TEST(Riccati, ByDoublingIsThatOfSlicot) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto system = drawn_system(seed, 3 + seed % 7, 1 + seed % 3);
    system.s.setZero();
    const auto p = prediction_covariance(system);
    const Eigen::MatrixXd seen = system.c.transpose() * system.r.inverse() * system.c;
    const auto doubled = doubled_riccati(system.a.transpose(), seen, system.q);
    EXPECT_LT((doubled - p).norm(), 1e-10 * p.norm()) << seed;
    const auto alone = doubled_riccati(system.a.transpose(), 0.0 * seen, system.q);
    const auto lyapunov = stationary_covariance(system.a, system.q);
    EXPECT_LT((alone - lyapunov).norm(), 1e-10 * lyapunov.norm()) << seed;
  }
}

// A state that grows is held by what sees it; without that there is no limit.
TEST(Riccati, ByDoublingNeedsALimit) {
  const auto one = [](double x) { return Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, x)); };
  const double p = prediction_covariance({one(1.3), one(1.0), one(2.0), one(1.0), one(0.0)})(0, 0);
  EXPECT_NEAR(doubled_riccati(one(1.3), one(1.0), one(2.0))(0, 0), p, 1e-10 * p);
  EXPECT_THROW(static_cast<void>(doubled_riccati(one(1.3), one(0.0), one(2.0))), NumericalFailure);
  EXPECT_THROW(static_cast<void>(doubled_riccati(one(1.0), one(0.0), one(2.0))), NumericalFailure);
  EXPECT_NE(refusal_of([&] {
              return doubled_riccati(one(0.5), one(1.0), Eigen::MatrixXd(2, 2));
            }).find("sizes"),
            std::string::npos);
}

TEST(Riccati, OfAnUnseenOrUndisturbedIntegratorHasNoSolution) {
  auto system = drawn_system(4, 5, 2);
  system.a.row(0).setZero();
  system.a.col(0).setZero();
  system.a(0, 0) = 1.0;
  auto unseen = system;
  unseen.c.col(0).setZero();
  EXPECT_THROW(static_cast<void>(prediction_covariance(unseen)), NumericalFailure);
  auto undisturbed = system;
  undisturbed.q.row(0).setZero();
  undisturbed.q.col(0).setZero();
  undisturbed.s.row(0).setZero();
  EXPECT_THROW(static_cast<void>(prediction_covariance(undisturbed)), NumericalFailure);
}

TEST(Riccati, RefusesWhatIsNoNoise) {
  auto system = drawn_system(5, 4, 2);
  system.r.setZero();
  EXPECT_NE(refusal_of([&] { return prediction_covariance(system); }).find("not positive definite"),
            std::string::npos);
  system = drawn_system(5, 4, 2);
  system.q(0, 0) = NAN;
  EXPECT_NE(refusal_of([&] { return prediction_covariance(system); }).find("not finite"),
            std::string::npos);
  system = drawn_system(5, 4, 2);
  system.s.resize(3, 2);
  EXPECT_NE(refusal_of([&] { return prediction_covariance(system); }).find("sizes"),
            std::string::npos);
}

TEST(StationaryCovariance, SolvesItsEquation) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto system = drawn_system(seed, 2 + seed, 1);
    const auto p = stationary_covariance(system.a, system.q);
    EXPECT_LT((system.a * p * system.a.transpose() + system.q - p).norm(), 1e-12 * p.norm());
    EXPECT_EQ(p, Eigen::MatrixXd(p.transpose()));
  }
}

TEST(StationaryCovariance, RefusesWhatDoesNotDecay) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(2, 2);
  for (const double size : {1.0, 1.2}) {
    EXPECT_THROW(static_cast<void>(stationary_covariance(size * one, one)), NumericalFailure);
  }
  EXPECT_FALSE(refusal_of([&] { return stationary_covariance(one, one.topRows(1)); }).empty());
}

}  // namespace
}  // namespace chladni::dense
