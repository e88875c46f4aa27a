#include "dense/blocks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dense/fortran.h"

namespace chladni::dense {
namespace {

constexpr double kOne = 1.0;
constexpr double kMinusOne = -1.0;
constexpr long kPanel = 64;         // columns eliminated before the rest is updated
constexpr long kColumnBlock = 192;  // columns per block in the update of a lower triangle

int fortran_int(long n) { return static_cast<int>(n); }

void trsm(const char* side, const char* transposed, const char* diagonal, Block l, Block b) {
  if (b.rows == 0 || b.columns == 0) return;
  const int m = fortran_int(b.rows);
  const int n = fortran_int(b.columns);
  const int lda = fortran_int(l.stride);
  const int ldb = fortran_int(b.stride);
  dtrsm_(side, "L", transposed, diagonal, &m, &n, &kOne, l.data, &lda, b.data, &ldb);
}

void gemm(const char* ta, const char* tb, long inner, Block a, Block b, Block c,
          const double& alpha = kMinusOne, const double& beta = kOne) {
  if (c.rows == 0 || c.columns == 0 || inner == 0) return;
  const int m = fortran_int(c.rows);
  const int n = fortran_int(c.columns);
  const int k = fortran_int(inner);
  const int lda = fortran_int(a.stride);
  const int ldb = fortran_int(b.stride);
  const int ldc = fortran_int(c.stride);
  dgemm_(ta, tb, &m, &n, &k, &alpha, a.data, &lda, b.data, &ldb, &beta, c.data, &ldc);
}

// LDLᵀ of a small square block, column by column, left-looking.
bool ldlt_unblocked(Block a, double* largest) {
  std::vector<double> scaled(static_cast<std::size_t>(a.columns));
  for (long j = 0; j < a.columns; ++j) {
    double* column = &a(j, j);
    for (long k = 0; k < j; ++k) scaled[static_cast<std::size_t>(k)] = a(j, k) * a(k, k);
    for (long k = 0; k < j; ++k) {
      const double f = scaled[static_cast<std::size_t>(k)];
      const double* from = &a(j, k);
      for (long i = 0; i < a.columns - j; ++i) column[i] -= f * from[i];
    }
    const double pivot = column[0];
    for (long i = 0; i < a.columns - j; ++i) largest[j] = std::max(largest[j], std::abs(column[i]));
    if (pivot == 0.0 || !std::isfinite(pivot)) return false;
    for (long i = 1; i < a.columns - j; ++i) column[i] /= pivot;
  }
  return true;
}

}  // namespace

bool cholesky(Block a) {
  const int n = fortran_int(a.columns);
  const int lda = fortran_int(a.stride);
  int info = 0;
  if (n > 0) dpotrf_("L", &n, a.data, &lda, &info);
  return info == 0;
}

bool ldlt(Block a, double* largest) {
  std::fill_n(largest, a.columns, 0.0);
  std::vector<double> scaled;
  for (long j = 0; j < a.columns; j += kPanel) {
    const long width = std::min(kPanel, a.columns - j);
    const long below = a.columns - j - width;
    const Block diagonal = a.part(j, j, width, width);
    if (!ldlt_unblocked(diagonal, largest + j)) return false;
    if (below == 0) break;
    const Block under = a.part(j + width, j, below, width);
    scaled.resize(static_cast<std::size_t>(below * width));
    const Block with_d{scaled.data(), below, width, below};
    eliminate_below(diagonal, under, with_d, largest + j);
    subtract_symmetric(with_d, under, a.part(j + width, j + width, below, below));
  }
  return true;
}

void eliminate_below(Block diagonal, Block b, Block with_d, double* largest) {
  solve_right(diagonal, b, true);
  for (long k = 0; k < b.columns; ++k) {
    const double d = diagonal(k, k);
    for (long i = 0; i < b.rows; ++i) {
      largest[k] = std::max(largest[k], std::abs(b(i, k)));
      with_d(i, k) = b(i, k);
      b(i, k) /= d;
    }
  }
}

void solve_right(Block l, Block b, bool unit) { trsm("R", "T", unit ? "U" : "N", l, b); }
void subtract_symmetric(Block a, Block b, Block c) {
  for (long j = 0; j < c.columns; j += kColumnBlock) {
    const long width = std::min(kColumnBlock, c.columns - j);
    gemm("N", "T", a.columns, a.part(j, 0, a.rows - j, a.columns), b.part(j, 0, width, b.columns),
         c.part(j, j, c.rows - j, width));
  }
}

void subtract_product(Block a, Block b, Block c) { gemm("N", "N", a.columns, a, b, c); }
void subtract_transposed_product(Block a, Block b, Block c) { gemm("T", "N", a.rows, a, b, c); }
void subtract_product_transposed(Block a, Block b, Block c) { gemm("N", "T", a.columns, a, b, c); }

}  // namespace chladni::dense
