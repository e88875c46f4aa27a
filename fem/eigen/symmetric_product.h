// Products of sparse symmetric matrices with several vectors at once.
#pragma once

#include <vector>

#include "base/arrays.h"

namespace chladni::fem {

/// Y := A X for a matrix A that stores its lower triangle. The object keeps room for eight columns
/// of X and Y, so that repeated products allocate nothing. The bits are the same on every run with
/// the same number of threads. Cost: eight columns take hardly longer than one, since the matrix is
/// read once for all of them.
class SymmetricProduct {
 public:
  /// @param lower  n×n; kept by reference
  explicit SymmetricProduct(const SparseMatrix& lower) : matrix_(lower) {}

  /// @param x  n×m. @param y  n×m, may not overlap x
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Ref<Eigen::MatrixXd> y);
  [[nodiscard]] Eigen::MatrixXd operator*(const Eigen::Ref<const Eigen::MatrixXd>& x);

 private:
  const SparseMatrix& matrix_;
  std::vector<double> x_, y_;  // a row's values for all columns lie together
};

}  // namespace chladni::fem
