// BLAS calls in one thread, whoever asks for it and in whatever order.
#include "dense/blas.h"

#include <gtest/gtest.h>

#include <memory>

extern "C" {
int openblas_get_num_threads() __attribute__((weak));
void openblas_set_num_threads(int) __attribute__((weak));
}

namespace chladni::dense {
namespace {

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
