// BLAS calls in one thread, whoever asks for it and in whatever order.
#include "dense/blas.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <memory>
#include <string>

#include "dense/algebra.h"

extern "C" {
int openblas_get_num_threads() __attribute__((weak));
void openblas_set_num_threads(int) __attribute__((weak));
}

namespace chladni::dense {
namespace {

// It calls the BLAS, without which this program would not be linked with one.
TEST(Algebra, IsThatOfEigen) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(7, 5);
  const Eigen::MatrixXd b = Eigen::MatrixXd::Random(5, 4);
  Eigen::MatrixXd c = Eigen::MatrixXd::Ones(7, 4);
  add_product(a, b, -2.0, c);
  EXPECT_LT((c - (Eigen::MatrixXd::Ones(7, 4) - 2.0 * a * b)).norm(), 1e-13);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Identity(5, 5);
  add_gram(a, gram);
  const Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(5, 5) + a.transpose() * a;
  EXPECT_LT(Eigen::MatrixXd((gram - whole).triangularView<Eigen::Lower>()).norm(), 1e-13);
  ASSERT_TRUE(cholesky(gram));
  Eigen::MatrixXd x = whole * b;
  solve(gram, x);
  solve_transposed(gram, x);
  EXPECT_LT((x - b).norm(), 1e-12);
}

TEST(SlowBlasKernel, NamesBothKernelsAndWhatToSet) {
  for (const std::string best : {"Haswell", "SkylakeX"}) {
    const auto text = slow_blas_kernel("Prescott", best, false);
    EXPECT_NE(text.find("kernel \"Prescott\""), std::string::npos) << text;
    EXPECT_NE(text.find("than \"" + best + "\""), std::string::npos) << text;
    EXPECT_NE(text.find("OPENBLAS_CORETYPE=" + best), std::string::npos) << text;
  }
  for (const auto* now : {"Haswell", "Zen", "Excavator", "Nehalem"}) {
    EXPECT_NE(slow_blas_kernel(now, "SkylakeX", false), "") << now;
  }
  EXPECT_NE(slow_blas_kernel("Sandybridge", "Haswell", false), "");
}

TEST(SlowBlasKernel, IsNoneWhereNothingIsFasterOrKnown) {
  for (const auto* now : {"Haswell", "Zen", "Excavator", "SkylakeX", "Cooperlake", "unknown"}) {
    EXPECT_EQ(slow_blas_kernel(now, "Haswell", false), "") << now;
  }
  for (const auto* now : {"SkylakeX", "Cooperlake", "Sapphirerapids", "unknown"}) {
    EXPECT_EQ(slow_blas_kernel(now, "SkylakeX", false), "") << now;
  }
  EXPECT_EQ(slow_blas_kernel("Prescott", "", false), "") << "a processor without AVX2";
}

TEST(SlowBlasKernel, IsLeftToTheUserWhoChoseIt) {
  EXPECT_EQ(slow_blas_kernel("Prescott", "Haswell", true), "");
}

TEST(OneBlasThread, LastsUntilTheLastOfThemIsGone) {
  if (openblas_set_num_threads == nullptr) GTEST_SKIP() << "another BLAS";
  const int before = openblas_get_num_threads();
  openblas_set_num_threads(2);
  if (openblas_get_num_threads() != 2) GTEST_SKIP() << "a BLAS of one thread";
  auto first = std::make_unique<OneBlasThread>();
  auto second = std::make_unique<OneBlasThread>();
  EXPECT_EQ(openblas_get_num_threads(), 1);
  first.reset();  // as tasks end: not in the order in which they began
  EXPECT_EQ(openblas_get_num_threads(), 1);
  second.reset();
  EXPECT_EQ(openblas_get_num_threads(), 2);
  openblas_set_num_threads(before);
}

}  // namespace
}  // namespace chladni::dense
