// What CHOLMOD does for us, against dense solvers; and its own LDLᵀ against our count.
#include "fem/factor/cholmod.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <random>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/factor_check.h"
#include "host/parallel.h"
#include "mesh/bodies.h"
#include "../random_body.h"

extern "C" int omp_get_max_active_levels() __attribute__((weak));

namespace chladni::fem {
namespace {

// A dense positive definite matrix of `columns` own columns and a border; the border's own entries
// do not count.
Eigen::MatrixXd random_definite(int size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Eigen::MatrixXd m =
      Eigen::MatrixXd::NullaryExpr(size, size, [&](auto, auto) { return uniform(random); });
  return m * m.transpose() + Eigen::MatrixXd::Identity(size, size);
}

// A part of two supernodes, the second of which is the whole rest of the columns.
struct DensePart {
  DensePart(const Eigen::MatrixXd& a, std::int32_t first_width, std::int32_t columns) {
    const auto size = static_cast<std::int32_t>(a.rows());
    shape.columns = columns;
    shape.border = size - columns;
    shape.first = {0, first_width};
    shape.start = {0, size, 2 * size - first_width};
    for (const auto from : shape.first) {
      for (std::int32_t i = from; i < size; ++i) shape.rows.push_back(i);
    }
    shape.place = {0, std::int64_t{size} * first_width};
    shape.panels = shape.place[1] + std::int64_t{size - first_width} * (columns - first_width);
    for (std::int32_t j = 0; j < columns; ++j) {
      matrix.start.push_back(static_cast<std::int32_t>(row.size()));
      matrix.count.push_back(size - j);
      for (std::int32_t i = j; i < size; ++i) {
        row.push_back(i);
        value.push_back(a(i, j));
      }
    }
    matrix.room = static_cast<std::int32_t>(row.size());
    row.push_back(0);
    value.push_back(0.0);
    matrix.row = row.data();
    matrix.value = value.data();
    values.assign(static_cast<std::size_t>(shape.panels + shape.border * shape.border), 0.0);
  }

  PartShape shape;
  PartMatrix matrix;
  std::vector<std::int32_t> row;
  std::vector<double> value, values;
};

TEST(Cholmod, LeavesWhatAPartSubtractsFromItsBorder) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const int size = 3 + static_cast<int>(seed) * 5;
    const int columns = 2 + static_cast<int>(seed * 7U) % (size - 2);
    const int width = 1 + static_cast<int>(seed * 3U) % (columns - 1);
    const auto a = random_definite(size, seed);
    const Eigen::MatrixXd l = a.topLeftCorner(columns, columns).llt().matrixL();
    const int border = size - columns;
    const Eigen::MatrixXd below =
        l.triangularView<Eigen::Lower>().solve(a.bottomLeftCorner(border, columns).transpose());
    const Eigen::MatrixXd expected = -below.transpose() * below;
    DensePart part(a, width, columns);
    ASSERT_TRUE(factorise(part.shape, part.matrix, part.values.data())) << seed;
    const Eigen::Map<const Eigen::MatrixXd> first(part.values.data(), size, width);
    EXPECT_NEAR(first(size - 1, 0), size == columns ? l(size - 1, 0) : below(0, border - 1), 1e-12);
    const Eigen::Map<const Eigen::MatrixXd> block(part.values.data() + part.shape.panels, border,
                                                  border);
    const Eigen::MatrixXd off = (block - expected).triangularView<Eigen::Lower>();
    EXPECT_LT(off.norm(), 1e-12 * (1.0 + expected.norm())) << seed;

    DensePart again(a, width, columns);  // with 64-bit indices
    ASSERT_TRUE(factorise(again.shape, again.matrix, again.values.data(), 0)) << seed;
    EXPECT_EQ(again.values, part.values) << seed;
  }
}

TEST(Cholmod, RefusesAPartThatIsNotDefinite) {
  for (const int at : {0, 3, 7, 11}) {
    auto a = random_definite(15, 5);
    a(at, at) = -1.0;
    for (const std::int64_t long_from : {std::int64_t{0}, std::int64_t{1} << 31U}) {
      DensePart part(a, 5, 12);
      EXPECT_FALSE(factorise(part.shape, part.matrix, part.values.data(), long_from)) << at;
    }
  }
  auto a = random_definite(15, 5);
  a(4, 2) = std::nan("");
  DensePart part(a, 5, 12);
  EXPECT_FALSE(factorise(part.shape, part.matrix, part.values.data()));
}

Eigen::MatrixXd whole(const SparseMatrix& lower) {
  return Eigen::MatrixXd(SparseMatrix(lower.selfadjointView<Eigen::Lower>()));
}

// Entries of the dense factor in an order of the degrees of freedom.
Eigen::Index entries_of_factor(const Eigen::MatrixXd& a, const std::vector<std::int32_t>& order) {
  Eigen::PermutationMatrix<Eigen::Dynamic> permutation(a.rows());
  for (std::size_t i = 0; i < order.size(); ++i) {
    permutation.indices()(order[i]) = static_cast<int>(i);
  }
  const Eigen::MatrixXd l = (permutation * a * permutation.transpose()).llt().matrixL();
  return (l.array() != 0.0).count();
}

// CHOLMOD may number the order's subtrees one after the other, which changes no entry of L.
TEST(Cholmod, KeepsTheOrderThatItIsGiven) {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, 0.05, 1), 2);
  const auto system = assemble(body, {isotropic(70e9, 0.33, 2700.0)});
  const auto graph = quotient_graph(system.stiffness);
  // A matrix of the same pattern, with entries that cannot cancel during the elimination.
  Eigen::MatrixXd a =
      (whole(system.stiffness).array() != 0.0).select(-1.0, whole(system.mass) * 0.0);
  a.diagonal().setConstant(static_cast<double>(a.rows()));
  auto order = nested_dissection(graph);
  std::mt19937 random(3);
  for (int shuffle = 0; shuffle < 2; ++shuffle) {
    const auto found = supernodes(graph, order);
    const auto dofs_of = [&](const std::vector<std::int32_t>& groups) {
      std::vector<std::int32_t> dofs;
      for (const auto group : groups) {
        const auto g = static_cast<std::size_t>(group);
        for (auto dof = graph.first[g]; dof < graph.first[g + 1]; ++dof) dofs.push_back(dof);
      }
      return dofs;
    };
    EXPECT_EQ(entries_of_factor(a, dofs_of(found.order)), entries_of_factor(a, dofs_of(order)));
    std::shuffle(order.begin(), order.end(), random);  // a bad order is kept too
  }
}

TEST(Cholmod, SolvesRandomBodies) {
  const int before = thread_count();
  for (unsigned seed = 1; seed <= 40; ++seed) {
    set_thread_count(1 + static_cast<int>(seed % 4));
    const auto system = random_body(seed).system;
    const double s = 1e5 * seed * seed;
    const Symbolic symbolic(system.stiffness, system.mass);
    const Factorization factor(symbolic, system.stiffness, s, system.mass);
    const Eigen::MatrixXd a = whole(system.stiffness) + s * whole(system.mass);
    const Eigen::MatrixXd b = Eigen::MatrixXd::NullaryExpr(
        a.rows(), 1 + seed % 6,
        [](auto i, auto j) { return std::sin(1.0 + 0.3 * double(i) + double(j)); });
    const Eigen::MatrixXd x = factor.solve(b);
    EXPECT_LT((a * x - b).norm(), 1e-14 * (a.norm() * x.norm() + b.norm())) << seed;
  }
  set_thread_count(before);
}

// One negative entry at every place of the order: in the first subtree, in a later one, above.
TEST(Cholmod, RefusesAMatrixThatIsNotDefiniteWhereverItIs) {
  const auto system = random_body(7).system;
  const int before = thread_count();
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    const Symbolic symbolic(system.stiffness, system.mass);
    const auto& order = symbolic.tree().order;
    for (std::size_t i = 0; i < order.size(); i += 1 + order.size() / 40) {
      auto stiffness = system.stiffness;
      stiffness.coeffRef(order[i], order[i]) *= -1.0;
      try {
        (void)Factorization(symbolic, stiffness, 1e3, system.mass);
        ADD_FAILURE() << "row " << i << " of the order, " << threads << " threads";
      } catch (const NumericalFailure& failure) {
        EXPECT_STREQ(failure.what(), "factorization: the matrix is not positive definite");
      }
    }
  }
  set_thread_count(before);
}

TEST(Cholmod, CountsWithItsOwnLdltWhatWeCount) {
  int counted = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const auto system = random_body(seed).system;
    const Symbolic symbolic(system.stiffness, system.mass);
    const double sigma = std::pow(2.0 * std::numbers::pi * 37.0 * seed, 2);
    const auto ours = inertia(symbolic, system.stiffness, -sigma, system.mass);
    if (!ours.trusted()) continue;
    const auto theirs = second_inertia(SparseMatrix(system.stiffness - sigma * system.mass));
    EXPECT_EQ(ours.negative, theirs.negative) << seed;
    EXPECT_EQ(ours.positive, theirs.positive) << seed;
    ++counted;
  }
  EXPECT_GE(counted, 150);
}

TEST(FactorCheck, AgreesOnSoundBodiesAndNotOnOthers) {
  const auto system = random_body(5).system;
  const auto check = factor_check(system, 20000.0);
  EXPECT_TRUE(check.good());
  EXPECT_GT(check.counted, system.rigid.cols());
  EXPECT_LT(check.residual, 1e-14);
  EXPECT_FALSE((FactorCheck{.counted = 8, .counted_by_cholmod = 9, .trusted = true}.good()));
  EXPECT_FALSE(
      (FactorCheck{.counted = 8, .counted_by_cholmod = 8, .trusted = true, .residual = 1e-9}
           .good()));
}

TEST(Cholmod, LeavesOpenMpAsItWas) {
  if (omp_get_max_active_levels == nullptr) GTEST_SKIP() << "no OpenMP";
  const int before = omp_get_max_active_levels();
  const auto system = random_body(2).system;
  const Symbolic symbolic(system.stiffness, system.mass);
  (void)Factorization(symbolic, system.stiffness, 1e7, system.mass);
  EXPECT_EQ(omp_get_max_active_levels(), before);
}

}  // namespace
}  // namespace chladni::fem
