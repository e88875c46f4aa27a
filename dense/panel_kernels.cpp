#include "dense/panel_kernels.h"

#include <algorithm>
#include <vector>

#include "base/cpu_clones.h"
#include "host/parallel.h"

namespace chladni::dense {
namespace {

// Four doubles at any address.
using Four [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;

// Prefetches the next columns during the work on the present ones. The columns are too short for
// the processor's own prefetching.
template <int K>
[[gnu::always_inline]] inline void fetch(const double* next, long lda) {
  for (int k = 0; k < K; ++k) __builtin_prefetch(next + k * lda);
}

// Y := Y − A X for K columns of A and C of Y.
template <int K, int C>
[[gnu::always_inline]] inline void subtract(const double* a, long lda, long rows, const double* x,
                                            long ldx, double* y, long ldy) {
  double factor[K][C];
  for (int k = 0; k < K; ++k) {
    for (int c = 0; c < C; ++c) factor[k][c] = x[k + c * ldx];
  }
  long i = 0;
  for (; i + 4 <= rows; i += 4) {
    Four sum[C];
    for (int c = 0; c < C; ++c) sum[c] = *reinterpret_cast<const Four*>(y + i + c * ldy);
    for (int k = 0; k < K; ++k) {
      const Four column = *reinterpret_cast<const Four*>(a + i + k * lda);
      for (int c = 0; c < C; ++c) sum[c] -= column * factor[k][c];
    }
    fetch<K>(a + i + K * lda, lda);
    for (int c = 0; c < C; ++c) *reinterpret_cast<Four*>(y + i + c * ldy) = sum[c];
  }
  for (; i < rows; ++i) {
    for (int c = 0; c < C; ++c) {
      for (int k = 0; k < K; ++k) y[i + c * ldy] -= a[i + k * lda] * factor[k][c];
    }
  }
}

// X := X + f Aᵀ Y for K columns of A and C of Y.
template <int K, int C>
[[gnu::always_inline]] inline void add_dots(const double* a, long lda, long rows, const double* y,
                                            long ldy, double f, double* x, long ldx) {
  Four sum[K][C] = {};
  long i = 0;
  for (; i + 4 <= rows; i += 4) {
    fetch<K>(a + i - K * lda, lda);
    Four right[C];
    for (int c = 0; c < C; ++c) right[c] = *reinterpret_cast<const Four*>(y + i + c * ldy);
    for (int k = 0; k < K; ++k) {
      const Four column = *reinterpret_cast<const Four*>(a + i + k * lda);
      for (int c = 0; c < C; ++c) sum[k][c] += column * right[c];
    }
  }
  for (int k = 0; k < K; ++k) {
    for (int c = 0; c < C; ++c) {
      double total = (sum[k][c][0] + sum[k][c][1]) + (sum[k][c][2] + sum[k][c][3]);
      for (long rest = i; rest < rows; ++rest) total += a[rest + k * lda] * y[rest + c * ldy];
      x[k + c * ldx] += f * total;
    }
  }
}

CHLADNI_WIDE void subtract_4_4(const double* a, long lda, long rows, const double* x, long ldx,
                               double* y, long ldy) {
  subtract<4, 4>(a, lda, rows, x, ldx, y, ldy);
}
CHLADNI_WIDE void subtract_4_1(const double* a, long lda, long rows, const double* x, long ldx,
                               double* y, long ldy) {
  subtract<4, 1>(a, lda, rows, x, ldx, y, ldy);
}
CHLADNI_WIDE void subtract_1_4(const double* a, long lda, long rows, const double* x, long ldx,
                               double* y, long ldy) {
  subtract<1, 4>(a, lda, rows, x, ldx, y, ldy);
}
CHLADNI_WIDE void subtract_1_1(const double* a, long lda, long rows, const double* x, long ldx,
                               double* y, long ldy) {
  subtract<1, 1>(a, lda, rows, x, ldx, y, ldy);
}
CHLADNI_WIDE void dots_4_4(const double* a, long lda, long rows, const double* y, long ldy,
                           double f, double* x, long ldx) {
  add_dots<4, 4>(a, lda, rows, y, ldy, f, x, ldx);
}
CHLADNI_WIDE void dots_4_1(const double* a, long lda, long rows, const double* y, long ldy,
                           double f, double* x, long ldx) {
  add_dots<4, 1>(a, lda, rows, y, ldy, f, x, ldx);
}
CHLADNI_WIDE void dots_1_4(const double* a, long lda, long rows, const double* y, long ldy,
                           double f, double* x, long ldx) {
  add_dots<1, 4>(a, lda, rows, y, ldy, f, x, ldx);
}
CHLADNI_WIDE void dots_1_1(const double* a, long lda, long rows, const double* y, long ldy,
                           double f, double* x, long ldx) {
  add_dots<1, 1>(a, lda, rows, y, ldy, f, x, ldx);
}

// Y := Y − A X for one or four columns of A and any number of columns of Y.
void subtract_columns(Block a, const double* x, long ldx, Block y) {
  long c = 0;
  for (; c + 4 <= y.columns; c += 4) {
    (a.columns == 4 ? subtract_4_4 : subtract_1_4)(a.data, a.stride, a.rows, x + c * ldx, ldx,
                                                   &y(0, c), y.stride);
  }
  for (; c < y.columns; ++c) {
    (a.columns == 4 ? subtract_4_1 : subtract_1_1)(a.data, a.stride, a.rows, x + c * ldx, ldx,
                                                   &y(0, c), y.stride);
  }
}

void dot_columns(Block a, Block y, double f, double* x, long ldx) {
  long c = 0;
  for (; c + 4 <= y.columns; c += 4) {
    (a.columns == 4 ? dots_4_4 : dots_1_4)(a.data, a.stride, a.rows, &y(0, c), y.stride, f,
                                           x + c * ldx, ldx);
  }
  for (; c < y.columns; ++c) {
    (a.columns == 4 ? dots_4_1 : dots_1_1)(a.data, a.stride, a.rows, &y(0, c), y.stride, f,
                                           x + c * ldx, ldx);
  }
}

// Number of columns, from column k on, that are processed together.
long together(long k, long columns) { return k + 4 <= columns ? 4 : 1; }

}  // namespace

void sweep_up(Block strip, Block front) {
  if (front.columns == 0) return;  // without columns there is no data
  for (long k = 0, step = 0; k < strip.columns; k += step) {
    step = together(k, strip.columns);
    for (long c = 0; c < front.columns; ++c) {
      for (long j = k; j < k + step; ++j) {
        front(j, c) /= strip(j, j);
        for (long i = j + 1; i < k + step; ++i) front(i, c) -= strip(i, j) * front(j, c);
      }
    }
    const long from = k + step;
    subtract_columns(strip.part(from, k, strip.rows - from, step), &front(k, 0), front.stride,
                     front.part(from, 0, strip.rows - from, front.columns));
  }
}

void sweep_down(Block strip, Block front) {
  if (front.columns == 0) return;
  // Takes the column groups of sweep_up in reverse order. Single columns are at the end.
  for (long k = strip.columns, step = 0; k > 0;) {
    step = k % 4 == 0 ? 4 : 1;
    k -= step;
    const long from = k + step;
    dot_columns(strip.part(from, k, strip.rows - from, step),
                front.part(from, 0, strip.rows - from, front.columns), -1.0, &front(k, 0),
                front.stride);
    for (long c = 0; c < front.columns; ++c) {
      for (long j = from - 1; j >= k; --j) {
        for (long i = j + 1; i < from; ++i) front(j, c) -= strip(i, j) * front(i, c);
        front(j, c) /= strip(j, j);
      }
    }
  }
}

namespace {

// Calls work(first row, rows, first column, their block of V) for blocks of the rows [from, to).
template <typename Work>
void each_block_of(Block v, long from, long to, const Work& work) {
  constexpr long kRows = 512;
  for (long i = from; i < to; i += kRows) {
    const long rows = std::min(kRows, to - i);
    for (long k = 0, step = 0; k < v.columns; k += step) {
      step = together(k, v.columns);
      work(i, rows, k, v.part(i, k, rows, step));
    }
  }
}

}  // namespace

Eigen::MatrixXd take_out(const Eigen::Ref<const Eigen::MatrixXd>& v, const Eigen::MatrixXd& x,
                         Eigen::MatrixXd& w) {
  constexpr long kWorthThreads = 500'000;  // entries; a thread costs about 30 µs to start
  const long ranges = std::clamp(v.size() / kWorthThreads, 1L, static_cast<long>(thread_count()));
  const Block basis = block(v);
  const Block left = block(x);
  const Block changed = block(w);
  const auto each = [&](const auto& work) {  // range of rows, on the threads
    parallel_ranges(static_cast<std::size_t>(ranges), [&](std::size_t begin, std::size_t end) {
      for (auto k = begin; k < end; ++k) {
        const auto range = static_cast<long>(k);
        work(k, basis.rows * range / ranges, basis.rows * (range + 1) / ranges);
      }
    });
  };
  std::vector<Eigen::MatrixXd> sums(static_cast<std::size_t>(ranges),
                                    Eigen::MatrixXd::Zero(v.cols(), x.cols()));
  each([&](std::size_t range, long from, long to) {
    auto& h = sums[range];
    each_block_of(basis, from, to, [&](long i, long rows, long k, Block part) {
      dot_columns(part, left.part(i, 0, rows, left.columns), 1.0, &h(k, 0), h.rows());
    });
  });
  auto& h = sums.front();
  for (std::size_t k = 1; k < sums.size(); ++k) h += sums[k];
  each([&](std::size_t, long from, long to) {
    each_block_of(basis, from, to, [&](long i, long rows, long k, Block part) {
      subtract_columns(part, &h(k, 0), h.rows(), changed.part(i, 0, rows, changed.columns));
    });
  });
  return h;
}

}  // namespace chladni::dense
