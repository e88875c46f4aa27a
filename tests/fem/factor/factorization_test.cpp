#include "fem/factor/factorization.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <chrono>
#include <csignal>
#include <functional>
#include <random>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "fem/assemble.h"
#include "fem/factor/elimination_tree.h"
#include "fem/modes.h"
#include "host/parallel.h"
#include "mesh/bodies.h"
#include "tests/fem/peak_memory.h"

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

System plate(double edge = 0.03) {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, edge, 1), 2);
  return assemble(body, {isotropic(70e9, 0.33, 2700.0)});
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

// The address of the first number of a row was taken where there is none.
TEST(Factorization, SolvesForNoRightHandSide) {
  const auto x = Factorization(random_matrix(40, 8.0, 1)).solve(Eigen::MatrixXd(40, 0));
  EXPECT_EQ(x.rows(), 40);
  EXPECT_EQ(x.cols(), 0);
}

TEST(Factorization, RefusesAnIndefiniteMatrix) {
  EXPECT_THROW(Factorization(random_matrix(50, 0.0, 3)), NumericalFailure);
}

// What holds: the same bits for the same number of threads, with an order and a tree of their own
// each time; for another number the same signs, figures of the pivots and digits but not bits.
TEST(Factorization, GivesTheSameBitsForTheSameNumberOfThreads) {
  const auto system = plate();
  const auto& k = system.stiffness;
  const auto b = right_hand_sides(k.rows(), 4);
  const int before = thread_count();
  const auto solved = [&](int threads) {
    set_thread_count(threads);
    const Symbolic symbolic(k, system.mass);
    return Factorization(symbolic, k, 1e7, system.mass).solve(b);
  };
  const auto counted = [&](int threads) {
    set_thread_count(threads);
    return inertia(Symbolic(k, system.mass), k, -4e8, system.mass);
  };
  const auto one = solved(1);
  const auto pivots = counted(1);
  for (const int threads : {1, 2, 3}) {
    const auto first = solved(threads);
    for (int run = 0; run < 3; ++run) EXPECT_TRUE(first == solved(threads)) << threads;
    EXPECT_LT((first - one).norm(), 1e-9 * one.norm()) << threads;
    const auto again = counted(threads);
    EXPECT_EQ(again.negative, pivots.negative);
    EXPECT_EQ(again.smallest_pivot, pivots.smallest_pivot);
    EXPECT_EQ(again.growth, pivots.growth);
  }
  set_thread_count(before);
}

// Two at once in one process, each with loops of its own.
TEST(Factorization, GivesTheSameBitsBesideAnotherOne) {
  const auto system = plate();
  const auto b = right_hand_sides(system.stiffness.rows(), 4);
  const Symbolic symbolic(system.stiffness, system.mass);
  const auto solved = [&] {
    return Factorization(symbolic, system.stiffness, 1e7, system.mass).solve(b);
  };
  const auto alone = solved();
  std::vector<Eigen::MatrixXd> found(4);
  std::vector<std::thread> threads;
  for (auto& one : found) threads.emplace_back([&] { one = solved(); });
  for (auto& thread : threads) thread.join();
  for (const auto& one : found) EXPECT_TRUE(one == alone);
}

TEST(Factorization, LeavesTheThreadsOfBlasAsTheyWere) {
  if (dense::blas_threads() == 0) GTEST_SKIP() << "not OpenBLAS";
  const int before = dense::blas_threads();
  const auto a = random_matrix(100, 8.0, 3);
  for (const int threads : {1, 2, 3}) {
    dense::set_blas_threads(threads);
    const Factorization factor(a);
    EXPECT_EQ(dense::blas_threads(), threads);
    SparseMatrix b(100, 100);
    b.setIdentity();
    (void)inertia(Symbolic(a), a, 0.5, b);
    EXPECT_EQ(dense::blas_threads(), threads);
    EXPECT_THROW(Factorization(random_matrix(50, 0.0, 3)), NumericalFailure);
    EXPECT_EQ(dense::blas_threads(), threads);
    {
      const dense::OneBlasThread outer;
      const dense::OneBlasThread inner;
      EXPECT_EQ(dense::blas_threads(), 1);
    }
    EXPECT_EQ(dense::blas_threads(), threads);
  }
  dense::set_blas_threads(before);
}

// One front that is the whole matrix: Ctrl-C is answered within it.
// A full matrix of so many rows: one front.
struct OneFront {
  explicit OneFront(int n) : b(n, n) {
    Eigen::MatrixXd full = Eigen::MatrixXd::Constant(n, n, 1.0);
    full.diagonal().array() += 2.0 * n;
    a = Eigen::MatrixXd(full.triangularView<Eigen::Lower>()).sparseView();
    b.setIdentity();
  }
  SparseMatrix a, b;
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Ctrl-C when the work has begun, from another thread.
std::thread person() {
  catch_interrupts();
  return std::thread([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(40));
    std::raise(SIGINT);
  });
}

// CHOLMOD's part of the work is one call, which hears nothing.
TEST(Factorization, AnswersCtrlCWhenCholmodHasDoneItsPart) {
  const OneFront front(3000);
  const Symbolic symbolic(front.a);
  ASSERT_EQ(symbolic.tree().nodes.size(), 1U);
  auto pressed = person();
  EXPECT_THROW(static_cast<void>(Factorization(symbolic, front.a, 0.0, front.b)), Interrupted);
  pressed.join();
  catch_interrupts();
}

TEST(Inertia, AnswersCtrlCWithinOneFront) {
  const OneFront front(4000);
  const Symbolic symbolic(front.a);
  ASSERT_EQ(symbolic.tree().nodes.size(), 1U);
  const auto count = [&] { (void)inertia(symbolic, front.a, -1.0, front.b); };
  const double whole = seconds_of(count);
  auto pressed = person();
  const double stopped = seconds_of([&] { EXPECT_THROW(count(), Interrupted); });
  pressed.join();
  EXPECT_LT(stopped, 0.5 * whole);
  catch_interrupts();
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
  EXPECT_GT(forecast.flops, 0.0);
}

// What L of a dense solver holds, and not much more: strips store some zeros.
TEST(Symbolic, ForecastsTheEntriesOfTheFactor) {
  const auto system = plate(0.06);
  const auto n = static_cast<int>(system.stiffness.rows());
  const Symbolic symbolic(system.stiffness);
  const auto& order = symbolic.tree().order;
  Eigen::PermutationMatrix<Eigen::Dynamic> permutation(n);
  for (int i = 0; i < n; ++i) permutation.indices()(order[static_cast<std::size_t>(i)]) = i;
  Eigen::MatrixXd a = dense(system.stiffness) + 1e7 * dense(system.mass);
  a = permutation * a * permutation.transpose();
  const Eigen::MatrixXd l = a.llt().matrixL();
  const auto exact = static_cast<double>((l.array() != 0.0).count());
  EXPECT_GE(symbolic.forecast().entries, exact);
  EXPECT_LT(symbolic.forecast().entries, 1.5 * exact);
}

TEST(Modes, TakeTheMemoryThatTheyForecast) {
  const auto system = plate(0.012);
  for (const int count : {5, 60}) {
    const ModesOptions options{.count = count};
    const auto peak = peak_of([&] { return modes(system, options).summary.forecast_bytes; });
    ASSERT_GT(peak.used, 0.0);
    EXPECT_LT(peak.used, 1.1 * peak.forecast + 8e6) << count;  // libraries and small vectors
    EXPECT_GT(peak.used, 0.6 * peak.forecast) << count;
    RecordProperty("used_over_forecast_" + std::to_string(count),
                   std::to_string(peak.used / peak.forecast));
  }
}

}  // namespace
}  // namespace chladni::fem
