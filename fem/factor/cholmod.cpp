// CHOLMOD's loops call OpenMP with four threads in every supernode, however many cores there are
// (Debian, SuiteSparse 5.12). The threads spin, and on one core the factorisation takes twice as
// long. Here OpenMP stays on one thread; the parts of the tree run on the cores instead.
#include "fem/factor/cholmod.h"

#include <cholmod.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/error.h"
#include "base/index.h"

// Weak, so that the program also links with a CHOLMOD without OpenMP.
extern "C" {
int omp_get_max_active_levels() __attribute__((weak));
void omp_set_max_active_levels(int) __attribute__((weak));
}

namespace chladni::fem {
namespace {

// While an object of this class lives, parallel regions of OpenMP that this thread enters run on
// this thread alone. The setting is the thread's own.
class SerialOpenMp {
 public:
  SerialOpenMp() {
    if (omp_set_max_active_levels == nullptr || omp_get_max_active_levels == nullptr) return;
    before_ = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
  }
  ~SerialOpenMp() {
    if (before_ >= 0) omp_set_max_active_levels(before_);
  }
  SerialOpenMp(const SerialOpenMp&) = delete;
  SerialOpenMp& operator=(const SerialOpenMp&) = delete;

 private:
  int before_ = -1;
};

// CHOLMOD's functions for each type of index.
template <typename Int>
struct Calls;
template <>
struct Calls<int> {
  static constexpr int kType = CHOLMOD_INT;
  static constexpr auto start = cholmod_start;
  static constexpr auto finish = cholmod_finish;
  static constexpr auto super_numeric = cholmod_super_numeric;
};
template <>
struct Calls<SuiteSparse_long> {
  static constexpr int kType = CHOLMOD_LONG;
  static constexpr auto start = cholmod_l_start;
  static constexpr auto finish = cholmod_l_finish;
  static constexpr auto super_numeric = cholmod_l_super_numeric;
};

template <typename Int>
struct Session {
  Session() {
    Calls<Int>::start(&common);
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = 1;
  }
  ~Session() { Calls<Int>::finish(&common); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Throws what CHOLMOD reports, less that a matrix is not positive definite.
  void check(const char* doing) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) {
      throw OutOfResources(fmt::format("factorization: no memory to be had to {}", doing));
    }
    if (common.status < CHOLMOD_OK) {
      throw NumericalFailure(
          fmt::format("factorization: CHOLMOD could not {} (status {})", doing, common.status));
    }
  }

  SerialOpenMp serial;
  cholmod_common common;
};

// A factor that CHOLMOD made, until the end of the scope.
struct OwnedFactor {
  OwnedFactor(cholmod_factor* made, cholmod_common& by) : factor(made), common(by) {}
  ~OwnedFactor() { cholmod_free_factor(&factor, &common); }
  OwnedFactor(const OwnedFactor&) = delete;
  OwnedFactor& operator=(const OwnedFactor&) = delete;
  cholmod_factor* factor;
  cholmod_common& common;
};

// A symmetric matrix as CHOLMOD sees it, of which the triangle of `stype` counts.
cholmod_sparse view(std::size_t size, int* start, int* row, double* value, int stype) {
  cholmod_sparse m{};
  m.nrow = m.ncol = size;
  m.nzmax = static_cast<std::size_t>(start[size]);
  m.p = start;
  m.i = row;
  m.x = value;
  m.stype = stype;
  m.itype = CHOLMOD_INT;
  m.xtype = value == nullptr ? CHOLMOD_PATTERN : CHOLMOD_REAL;
  m.dtype = CHOLMOD_DOUBLE;
  m.packed = 1;
  return m;
}

std::vector<std::int32_t> copied(const void* data, std::size_t size) {
  const auto* from = static_cast<const int*>(data);
  return {from, from + size};
}

// Joins supernodes at the widths of Chen et al. (2008, ACM Trans. Math. Softw. 35, 22), widened for
// three degrees of freedom per node. CHOLMOD counts groups here.
void choose_joining(const QuotientGraph& graph, cholmod_common& common) {
  const auto groups = static_cast<double>(graph.first.size() - 1);
  const double size = std::max(1.0, graph.first.back() / std::max(groups, 1.0));
  const double widths[] = {12.0, 32.0, 96.0};
  const double zeros[] = {0.8, 0.1, 0.03};
  for (std::size_t i = 0; i < 3; ++i) {
    common.nrelax[i] = static_cast<std::size_t>(std::lround(widths[i] / size));
    common.zrelax[i] = zeros[i];
  }
}

// The most doubles and the most rows of an update that one supernode makes to another.
struct Updates {
  std::int64_t largest = 1, tallest = 1;
};

Updates updates_of(const PartShape& shape) {
  const auto count = shape.first.size();
  std::vector<std::int32_t> node_of(at(shape.columns + shape.border),
                                    static_cast<std::int32_t>(count));
  for (std::size_t k = 0; k < count; ++k) {
    const auto end = k + 1 < count ? shape.first[k + 1] : shape.columns;
    std::fill(node_of.begin() + shape.first[k], node_of.begin() + end,
              static_cast<std::int32_t>(k));
  }
  Updates found{.largest = std::int64_t{1} * shape.border * shape.border};
  for (std::size_t k = 0; k < count; ++k) {
    const auto end = k + 1 < count ? shape.first[k + 1] : shape.columns;
    auto begin = shape.start[k] + end - shape.first[k];
    found.tallest = std::max(found.tallest, shape.start[k + 1] - begin);
    while (begin < shape.start[k + 1]) {
      auto next = begin;
      const auto node = node_of[at(shape.rows[at(begin)])];
      while (next < shape.start[k + 1] && node_of[at(shape.rows[at(next)])] == node) ++next;
      found.largest = std::max(found.largest, (next - begin) * (shape.start[k + 1] - begin));
      begin = next;
    }
  }
  return found;
}

// CHOLMOD's symbolic factor of a part. The border is one more supernode.
template <typename Int>
struct PartFactor {
  explicit PartFactor(const PartShape& shape)
      : first(shape.first.begin(), shape.first.end()),
        start(shape.start.begin(), shape.start.end()),
        rows(shape.rows.begin(), shape.rows.end()),
        place(shape.place.begin(), shape.place.end()) {
    first.push_back(shape.columns);
    place.push_back(static_cast<Int>(shape.panels));
    if (shape.border > 0) {
      for (Int i = 0; i < shape.border; ++i) rows.push_back(shape.columns + i);
      start.push_back(static_cast<Int>(rows.size()));
      first.push_back(shape.columns + shape.border);
      place.push_back(
          static_cast<Int>(shape.panels + std::int64_t{1} * shape.border * shape.border));
    }
  }

  cholmod_factor seen_with(double* values, const PartShape& shape) {
    const auto updates = updates_of(shape);
    cholmod_factor f{};
    f.n = f.minor = static_cast<std::size_t>(shape.columns + shape.border);
    f.nsuper = first.size() - 1;
    f.ssize = rows.size();
    // CHOLMOD zeroes a supernode that it refuses up to here, and so not the border's block.
    f.xsize = static_cast<std::size_t>(shape.panels);
    f.maxcsize = static_cast<std::size_t>(updates.largest);
    f.maxesize = static_cast<std::size_t>(updates.tallest);
    f.super = first.data();
    f.pi = start.data();
    f.px = place.data();
    f.s = rows.data();
    f.x = values;
    f.ordering = CHOLMOD_NATURAL;
    f.is_ll = f.is_super = f.is_monotonic = 1;
    f.itype = Calls<Int>::kType;
    f.xtype = CHOLMOD_REAL;
    f.dtype = CHOLMOD_DOUBLE;
    return f;
  }

  std::vector<Int> first, start, rows, place;
};

// The columns of a part as CHOLMOD sees them. The border's first diagonal entry is −1 and its other
// entries are zero.
template <typename Int>
struct PartColumns {
  PartColumns(const PartShape& shape, const PartMatrix& matrix)
      : start(matrix.start.begin(), matrix.start.end()),
        count(matrix.count.begin(), matrix.count.end()) {
    const auto size = at(shape.columns + shape.border);
    start.resize(size + 1, matrix.room);
    count.resize(size, 0);
    if (shape.border > 0) {
      count[at(shape.columns)] = 1;
      matrix.row[matrix.room] = shape.columns;
      matrix.value[matrix.room] = -1.0;
    }
    seen.nrow = seen.ncol = size;
    seen.nzmax = static_cast<std::size_t>(matrix.room) + 1;
    seen.p = start.data();
    seen.nz = count.data();
    seen.x = matrix.value;
    if constexpr (std::is_same_v<Int, int>) {
      seen.i = matrix.row;
    } else {
      rows.resize(seen.nzmax);
      for (std::size_t j = 0; j < size; ++j) {  // other parts change their rows meanwhile
        std::copy_n(matrix.row + start[j], count[j], rows.data() + start[j]);
      }
      seen.i = rows.data();
    }
    seen.stype = -1;
    seen.itype = Calls<Int>::kType;
    seen.xtype = CHOLMOD_REAL;
    seen.dtype = CHOLMOD_DOUBLE;
  }

  std::vector<Int> start, count, rows;
  cholmod_sparse seen{};
};

// The border's block is the Schur complement's update because CHOLMOD refuses it at its first
// pivot, which is negative: by then it has subtracted all that the columns before it subtract, and
// has eliminated nothing of it.
template <typename Int>
bool factorised(const PartShape& shape, const PartMatrix& matrix, double* values) {
  Session<Int> session;
  PartFactor<Int> part(shape);
  PartColumns<Int> columns(shape, matrix);
  auto factor = part.seen_with(values, shape);
  double none[] = {0.0, 0.0};
  Calls<Int>::super_numeric(&columns.seen, nullptr, none, &factor, &session.common);
  session.check("factorise");
  if (factor.minor < static_cast<std::size_t>(shape.columns)) return false;
  if (shape.border == 0) return true;
  double& corner = values[shape.panels];
  if (corner == 0.0) throw NumericalFailure("factorization: this CHOLMOD clears what it refuses");
  if (!(corner < 0.0)) return false;  // not a number
  corner += 1.0;
  return true;
}

}  // namespace

GroupSupernodes supernodes(const QuotientGraph& graph, const std::vector<std::int32_t>& order) {
  if (order.empty()) return {{}, {0}, {0}, {}};
  Session<int> session;
  choose_joining(graph, session.common);
  auto start = graph.start;
  auto neighbour = graph.neighbour;
  auto given = order;
  auto pattern = view(order.size(), start.data(), neighbour.data(), nullptr, 1);
  const OwnedFactor owned(cholmod_analyze_p(&pattern, given.data(), nullptr, 0, &session.common),
                          session.common);
  session.check("analyse");
  const auto& f = *owned.factor;
  return {copied(f.Perm, f.n), copied(f.super, f.nsuper + 1), copied(f.pi, f.nsuper + 1),
          copied(f.s, f.ssize)};
}

std::int64_t work_size(const PartShape& shape) { return updates_of(shape).largest; }

bool factorise(const PartShape& shape, const PartMatrix& matrix, double* values,
               std::int64_t long_from) {
  const auto size = shape.panels + std::int64_t{1} * shape.border * shape.border;
  return size < long_from ? factorised<int>(shape, matrix, values)
                          : factorised<SuiteSparse_long>(shape, matrix, values);
}

Inertia second_inertia(const SparseMatrix& matrix) {
  Session<int> session;
  session.common.supernodal = CHOLMOD_SIMPLICIAL;
  session.common.method[0].ordering = CHOLMOD_AMD;
  SparseMatrix copy = matrix;
  copy.makeCompressed();
  auto seen =
      view(at(copy.cols()), copy.outerIndexPtr(), copy.innerIndexPtr(), copy.valuePtr(), -1);
  const OwnedFactor owned(cholmod_analyze(&seen, &session.common), session.common);
  session.check("analyse");
  cholmod_factorize(&seen, owned.factor, &session.common);
  session.check("factorise");
  const auto& f = *owned.factor;
  if (f.minor < f.n) throw NumericalFailure("factorization: a pivot of LDLᵀ is zero");
  Inertia found;
  const auto* first = static_cast<const int*>(f.p);
  const auto* value = static_cast<const double*>(f.x);
  for (std::size_t j = 0; j < f.n; ++j) ++(value[first[j]] < 0.0 ? found.negative : found.positive);
  return found;
}

}  // namespace chladni::fem
