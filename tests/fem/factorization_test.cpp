#include "fem/factorization.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "base/error.h"
#include "base/parallel.h"

namespace chladni::fem {
namespace {

// A random sparse symmetric matrix, lower triangle; its diagonal makes it positive definite when
// `shift` is large. Some are in blocks of three, some have rows that touch nothing.
SparseMatrix random_matrix(int n, double shift, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, shift + uniform(random));
  const int links = 2 * n;
  for (int k = 0; k < links; ++k) {
    const int a = static_cast<int>(random() % static_cast<unsigned>(n));
    const int b = static_cast<int>(random() % static_cast<unsigned>(n));
    if (a > b && a % 17 != 0) entries.emplace_back(a, b, uniform(random));
  }
  SparseMatrix m(n, n);
  m.setFromTriplets(entries.begin(), entries.end());
  return m;
}

Eigen::MatrixXd dense(const SparseMatrix& lower) {
  const SparseMatrix both = lower.selfadjointView<Eigen::Lower>();
  return Eigen::MatrixXd(both);
}

Eigen::MatrixXd right_hand_sides(Eigen::Index n, Eigen::Index columns) {
  return Eigen::MatrixXd::NullaryExpr(
      n, columns, [](auto i, auto j) { return std::sin(1.0 + double(i) * 0.37 + double(j)); });
}

TEST(Factorization, SolvesWhatADenseSolverSolves) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int n = 1 + static_cast<int>(seed) * 15;
    const auto a = random_matrix(n, 8.0, seed);
    const auto b = right_hand_sides(n, 1 + seed % 5);
    const Eigen::MatrixXd expected = dense(a).llt().solve(b);
    EXPECT_LT((Factorization(a).solve(b) - expected).norm(), 1e-11 * expected.norm()) << seed;
  }
}

TEST(Factorization, RefusesAnIndefiniteMatrix) {
  EXPECT_THROW(Factorization(random_matrix(50, 0.0, 3)), NumericalFailure);
}

TEST(Factorization, GivesTheSameBitsOnOneCoreAndOnTwo) {
  const auto a = random_matrix(400, 8.0, 5);
  const auto b = right_hand_sides(400, 4);
  const Symbolic symbolic(a);
  const SparseMatrix none(400, 400);
  set_thread_count(1);
  const auto one = Factorization(symbolic, a, 0.0, none).solve(b);
  set_thread_count(2);
  const auto two = Factorization(symbolic, a, 0.0, none).solve(b);
  EXPECT_LT((one - two).norm(), 1e-13 * one.norm());
  EXPECT_EQ((two - Factorization(symbolic, a, 0.0, none).solve(b)).norm(), 0.0);
}

TEST(Inertia, CountsWhatADenseSolverCounts) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const int n = 2 + static_cast<int>(seed) * 4;
    const auto a = random_matrix(n, 0.0, seed);
    SparseMatrix b(n, n);
    b.setIdentity();
    const double s = -1.5 + 0.05 * seed;
    const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(a)).eigenvalues();
    const auto counted = inertia(Symbolic(a), a, s, b);
    EXPECT_EQ(counted.negative, (values.array() < -s).count()) << seed;
    EXPECT_EQ(counted.negative + counted.positive, n);
  }
}

TEST(Symbolic, ForecastsAtLeastTheMatrixItself) {
  const auto a = random_matrix(300, 8.0, 1);
  const auto forecast = Symbolic(a).forecast();
  EXPECT_GE(forecast.entries, static_cast<double>(a.nonZeros()));
  EXPECT_EQ(forecast.factor_bytes, 8.0 * forecast.entries);
  EXPECT_GT(forecast.flops, 0.0);
}

}  // namespace
}  // namespace chladni::fem
