#include "fem/eigen/symmetric_product.h"

#include <algorithm>

#include "base/cpu_clones.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

struct Lower {
  const int* outer;
  const int* inner;
  const double* value;
  long n;
};

// Columns [first, last) of a lower triangle: they touch the rows from `first` on.
struct Columns {
  long first = 0, last = 0;
};

// y := A x for `Width` vectors, A being those columns and their mirror image; the values of one row
// lie together.
template <int Width>
[[gnu::always_inline]] inline void multiply(Lower a, Columns part, const double* __restrict x,
                                            double* __restrict y) {
  std::fill_n(y + part.first * Width, (a.n - part.first) * Width, 0.0);
  for (long c = part.first; c < part.last; ++c) {
    double own[Width];
    double sum[Width] = {};
    for (int j = 0; j < Width; ++j) own[j] = x[c * Width + j];
    int k = a.outer[c];
    const int end = a.outer[c + 1];
    for (; k < end && a.inner[k] == c; ++k) {
      for (int j = 0; j < Width; ++j) sum[j] += a.value[k] * own[j];
    }
    for (; k < end; ++k) {
      const double v = a.value[k];
      const double* from = x + long{a.inner[k]} * Width;
      double* to = y + long{a.inner[k]} * Width;
      for (int j = 0; j < Width; ++j) {
        sum[j] += v * from[j];
        to[j] += v * own[j];
      }
    }
    for (int j = 0; j < Width; ++j) y[c * Width + j] += sum[j];
  }
}

CHLADNI_WIDE void multiply_four(Lower a, Columns part, const double* x, double* y) {
  multiply<4>(a, part, x, y);
}
CHLADNI_WIDE void multiply_eight(Lower a, Columns part, const double* x, double* y) {
  multiply<8>(a, part, x, y);
}

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

// Parts of about equal numbers of entries, one per thread where that is worth it.
std::vector<Columns> parts_of(Lower a) {
  constexpr long kWorthThreads = 100'000;  // entries; a thread costs about 30 µs to start
  const long entries = a.outer[a.n];
  const long count = std::clamp(entries / kWorthThreads, 1L, static_cast<long>(thread_count()));
  std::vector<Columns> parts;
  long first = 0;
  for (long k = 1; k <= count; ++k) {
    const auto* end = std::lower_bound(a.outer, a.outer + a.n, entries / count * k);
    const long last = k == count ? a.n : std::max(first, static_cast<long>(end - a.outer));
    parts.push_back({first, last});
    first = last;
  }
  return parts;
}

// Calls work(first row, rows) for `count` ranges of the rows, on the threads.
template <typename Work>
void each_range(std::size_t count, long rows, const Work& work) {
  parallel_ranges(count, [&](std::size_t begin, std::size_t end) {
    const auto from = rows * static_cast<long>(begin) / static_cast<long>(count);
    const auto to = rows * static_cast<long>(end) / static_cast<long>(count);
    work(from, to - from);
  });
}

}  // namespace

// The parts' products are added in the order of the parts.
void SymmetricProduct::apply(const Eigen::Ref<const Eigen::MatrixXd>& x,
                             Eigen::Ref<Eigen::MatrixXd> y) {
  const Lower a{matrix_.outerIndexPtr(), matrix_.innerIndexPtr(), matrix_.valuePtr(),
                matrix_.cols()};
  const auto parts = parts_of(a);
  const Eigen::Index width = x.cols() <= 4 ? 4 : 8;
  const long size = a.n * width;
  x_.resize(static_cast<std::size_t>(size));
  y_.resize(x_.size() * parts.size());
  for (Eigen::Index first = 0; first < x.cols(); first += width) {
    const auto columns = std::min(width, x.cols() - first);
    each_range(parts.size(), a.n, [&](long row, long rows) {
      gather(x.block(row, first, rows, columns), width, x_.data() + row * width);
    });
    parallel_ranges(parts.size(), [&](std::size_t begin, std::size_t end) {
      for (auto k = begin; k < end; ++k) {
        double* own = y_.data() + static_cast<long>(k) * size;
        (width == 4 ? multiply_four : multiply_eight)(a, parts[k], x_.data(), own);
      }
    });
    each_range(parts.size(), a.n, [&](long row, long rows) {
      double* sum = y_.data() + row * width;
      for (std::size_t k = 1; k < parts.size(); ++k) {
        const double* own = sum + static_cast<long>(k) * size;
        for (long i = std::max(0L, parts[k].first - row) * width; i < rows * width; ++i) {
          sum[i] += own[i];
        }
      }
      scatter(sum, width, y.block(row, first, rows, columns));
    });
  }
}

Eigen::MatrixXd SymmetricProduct::operator*(const Eigen::Ref<const Eigen::MatrixXd>& x) {
  Eigen::MatrixXd y(x.rows(), x.cols());
  apply(x, y);
  return y;
}

}  // namespace chladni::fem
