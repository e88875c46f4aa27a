// The dense kernels under the sparse factorisation: BLAS and LAPACK on column-major blocks.
#pragma once

#include <Eigen/Core>

namespace chladni::dense {

/// A block of a column-major array: entry (i, j) at data[i + j * stride].
struct Block {
  double* data = nullptr;
  long rows = 0, columns = 0, stride = 0;
  [[nodiscard]] Block part(long i, long j, long r, long c) const {
    return {data + i + j * stride, r, c, stride};
  }
  double& operator()(long i, long j) const { return data[i + j * stride]; }
};

/// A matrix as a block. The block of a const matrix must only be read.
[[nodiscard]] inline Block block(const Eigen::Ref<const Eigen::MatrixXd>& m) {
  return {const_cast<double*>(m.data()), m.rows(), m.cols(), m.outerStride()};
}

/// A = LLᵀ in place, lower triangle. False where a pivot is not positive.
[[nodiscard]] bool cholesky(Block a);

/// A = LDLᵀ in place without exchanges: unit L below the diagonal, D on it.
/// @param largest  per column: the largest entry on and below its pivot when it is eliminated
/// @return  false where a pivot is 0 or not finite; the content of `a` is then undefined
[[nodiscard]] bool ldlt(Block a, double* largest);

/// Eliminates the rows B below a block that `ldlt` has eliminated. B becomes the rows of L,
/// `with_d` the rows of L D.
/// @param largest  per column, raised to the largest entry of L D here
void eliminate_below(Block diagonal, Block b, Block with_d, double* largest);

/// B := B L⁻ᵀ, L lower (unit diagonal where `unit`).
void solve_right(Block l, Block b, bool unit);
/// C := C − A Bᵀ, lower triangle only (A Bᵀ is symmetric).
void subtract_symmetric(Block a, Block b, Block c);
/// C := C − A B; C := C − Aᵀ B; C := C − A Bᵀ.
void subtract_product(Block a, Block b, Block c);
void subtract_transposed_product(Block a, Block b, Block c);
void subtract_product_transposed(Block a, Block b, Block c);

}  // namespace chladni::dense
