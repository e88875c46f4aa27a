#include "fem/eigen/symmetric_product.h"

#include <algorithm>

#include "base/cpu_clones.h"

namespace chladni::fem {
namespace {

struct Lower {
  const int* outer;
  const int* inner;
  const double* value;
  long n;
};

// y := A x for `Columns` vectors; the values of one row lie together.
template <int Columns>
[[gnu::always_inline]] inline void multiply(Lower a, const double* __restrict x,
                                            double* __restrict y) {
  std::fill_n(y, a.n * Columns, 0.0);
  for (long c = 0; c < a.n; ++c) {
    double own[Columns];
    double sum[Columns] = {};
    for (int j = 0; j < Columns; ++j) own[j] = x[c * Columns + j];
    int k = a.outer[c];
    const int end = a.outer[c + 1];
    for (; k < end && a.inner[k] == c; ++k) {
      for (int j = 0; j < Columns; ++j) sum[j] += a.value[k] * own[j];
    }
    for (; k < end; ++k) {
      const double v = a.value[k];
      const double* from = x + long{a.inner[k]} * Columns;
      double* to = y + long{a.inner[k]} * Columns;
      for (int j = 0; j < Columns; ++j) {
        sum[j] += v * from[j];
        to[j] += v * own[j];
      }
    }
    for (int j = 0; j < Columns; ++j) y[c * Columns + j] += sum[j];
  }
}

CHLADNI_WIDE void multiply_four(Lower a, const double* x, double* y) { multiply<4>(a, x, y); }
CHLADNI_WIDE void multiply_eight(Lower a, const double* x, double* y) { multiply<8>(a, x, y); }

// Copies column-major data to rows of `width`; `scatter` copies back.
void gather(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Index width, double* rows) {
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    for (Eigen::Index j = 0; j < x.cols(); ++j) rows[i * width + j] = x(i, j);
  }
}

void scatter(const double* rows, Eigen::Index width, Eigen::Ref<Eigen::MatrixXd> y) {
  for (Eigen::Index i = 0; i < y.rows(); ++i) {
    for (Eigen::Index j = 0; j < y.cols(); ++j) y(i, j) = rows[i * width + j];
  }
}

}  // namespace

void SymmetricProduct::apply(const Eigen::Ref<const Eigen::MatrixXd>& x,
                             Eigen::Ref<Eigen::MatrixXd> y) {
  const Lower a{matrix_.outerIndexPtr(), matrix_.innerIndexPtr(), matrix_.valuePtr(),
                matrix_.cols()};
  const Eigen::Index width = x.cols() <= 4 ? 4 : 8;
  x_.resize(static_cast<std::size_t>(a.n * width));
  y_.resize(x_.size());
  for (Eigen::Index first = 0; first < x.cols(); first += width) {
    const auto columns = std::min(width, x.cols() - first);
    gather(x.middleCols(first, columns), width, x_.data());
    (width == 4 ? multiply_four : multiply_eight)(a, x_.data(), y_.data());
    scatter(y_.data(), width, y.middleCols(first, columns));
  }
}

Eigen::MatrixXd SymmetricProduct::operator*(const Eigen::Ref<const Eigen::MatrixXd>& x) {
  Eigen::MatrixXd y(x.rows(), x.cols());
  apply(x, y);
  return y;
}

}  // namespace chladni::fem
