// Multifrontal factorisation (Duff and Reid 1983) on the elimination tree: each node assembles a
// dense front from the matrix and its children's update blocks, eliminates its columns with BLAS,
// and hands its own update block up. Subtrees run on both cores; sums are in a fixed order, so the
// bits do not depend on which core does what.
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/parallel.h"
#include "fem/blas.h"
#include "fem/dense.h"
#include "fem/elimination_tree.h"

namespace chladni::fem {
namespace {

using Tree = Symbolic::Tree;
using dense::Block;
std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// A + s B in the order of elimination: the column's entries below the diagonal, unsorted; entries
// of A and of B stand beside each other and are summed by the front.
struct Permuted {
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> row;
  std::vector<double> value;
};

Permuted permuted(const Tree& tree, const SparseMatrix& a, double s, const SparseMatrix* b) {
  Permuted p{std::vector<std::int64_t>(tree.order.size() + 1, 0), {}, {}};
  const auto each = [&](const SparseMatrix& m, const auto& visit) {
    for (Eigen::Index c = 0; c < m.cols(); ++c) {
      const auto pc = tree.position[at(c)];
      for (SparseMatrix::InnerIterator e(m, c); e; ++e) {
        const auto pr = tree.position[at(e.row())];
        visit(std::min(pc, pr), std::max(pc, pr), e.value());
      }
    }
  };
  const auto count = [&](std::int32_t column, std::int32_t, double) { ++p.start[at(column) + 1]; };
  each(a, count);
  if (b != nullptr) each(*b, count);
  for (std::size_t i = 0; i < tree.order.size(); ++i) p.start[i + 1] += p.start[i];
  p.row.resize(at(p.start.back()));
  p.value.resize(p.row.size());
  auto next = p.start;
  double factor = 1.0;
  const auto store = [&](std::int32_t column, std::int32_t row, double value) {
    const auto k = at(next[at(column)]++);
    p.row[k] = row;
    p.value[k] = factor * value;
  };
  each(a, store);
  factor = s;
  if (b != nullptr) each(*b, store);
  return p;
}

// Doubles straight from the system, in pages of 2 MiB where it has them: a fault per 4 KiB costs
// more than the arithmetic. Zero at first.
class Storage {
 public:
  Storage() = default;
  explicit Storage(std::int64_t doubles)
      : size_(at(doubles)), bytes_(std::max<std::size_t>(size_ * sizeof(double), 1)) {
    void* p = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED) {
      throw OutOfResources("factorization: no " + std::to_string(bytes_ >> 20U) + " MiB to be had");
    }
    if (bytes_ > (std::size_t{4} << 20U)) madvise(p, bytes_, MADV_HUGEPAGE);
    data_ = static_cast<double*>(p);
  }
  ~Storage() {
    if (data_ != nullptr) munmap(data_, bytes_);
  }
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;
  Storage(Storage&& other) noexcept { swap(other); }
  Storage& operator=(Storage&& other) noexcept {
    swap(other);
    return *this;
  }
  [[nodiscard]] double* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void swap(Storage& other) {
    std::swap(size_, other.size_);
    std::swap(bytes_, other.bytes_);
    std::swap(data_, other.data_);
  }
  std::size_t size_ = 0;
  std::size_t bytes_ = 0;
  double* data_ = nullptr;
};

// Square blocks whose storage is used again, since fresh pages are dear.
class Pool {
 public:
  /// At least rows·columns doubles, not cleared.
  Storage take(long rows, long columns) {
    const auto size = at(rows * columns);
    auto best = free_.end();
    for (auto it = free_.begin(); it != free_.end(); ++it) {
      if (it->size() >= size && (best == free_.end() || it->size() < best->size())) best = it;
    }
    if (best == free_.end() || best->size() > 4 * size + 65536) {
      return Storage(static_cast<std::int64_t>(size + size / 8 + 512));
    }
    Storage found = std::move(*best);
    free_.erase(best);
    return found;
  }
  void give(Storage storage) {
    if (free_.size() >= 16) {
      free_.erase(std::min_element(free_.begin(), free_.end(), [](const auto& x, const auto& y) {
        return x.size() < y.size();
      }));
    }
    free_.push_back(std::move(storage));
  }

 private:
  std::vector<Storage> free_;
};

void clear_lower(Block block) {
  for (long j = 0; j < block.columns; ++j) std::fill_n(&block(j, j), block.rows - j, 0.0);
}

// What one thread needs besides the tree.
struct Worker {
  explicit Worker(std::size_t n) : local(n, -1) {}
  std::vector<std::int32_t> local;  // row in the order of elimination -> row of the front
  Pool pool;
};

// Runs node by node: the subtrees on all threads, then the top with threads inside BLAS.
template <typename NodeWork>
void walk_up(const Tree& tree, std::vector<Worker>& workers, const NodeWork& work) {
  const auto threads = workers.size();
  std::atomic<std::size_t> next{0};
  const auto take_subtrees = [&](std::size_t begin, std::size_t end) {
    for (auto w = begin; w < end; ++w) {
      for (auto k = next++; k < tree.subtrees.size(); k = next++) {
        const auto root = tree.subtrees[k];
        auto first = root;
        while (!tree.nodes[at(first)].children.empty()) {
          first = tree.nodes[at(first)].children.front();
        }
        for (auto s = first; s <= root; ++s) work(s, workers[w]);
      }
    }
  };
  set_blas_threads(1);
  parallel_ranges(threads, take_subtrees);
  set_blas_threads(static_cast<int>(threads));
  for (const auto s : tree.top) work(s, workers.front());
  set_blas_threads(1);
}

// The update blocks wait here until the parent takes them.
class Fronts {
 public:
  Fronts(const Tree& tree, const Permuted& matrix)
      : tree_(tree), matrix_(matrix), update_(tree.nodes.size()) {}

  // Assembles the front of node s: its panel into `panel` (zeroed), its update block kept.
  Block assemble(std::int32_t s, Block panel, Worker& worker) {
    const auto& node = tree_.nodes[at(s)];
    const auto r = static_cast<long>(node.rows.size());
    for (std::int32_t j = 0; j < node.width; ++j) worker.local[at(node.first + j)] = j;
    for (long i = 0; i < r; ++i) {
      worker.local[at(node.rows[at(i)])] = static_cast<std::int32_t>(node.width + i);
    }
    for (std::int32_t j = 0; j < node.width; ++j) {
      const auto column = at(node.first + j);
      for (auto k = matrix_.start[column]; k < matrix_.start[column + 1]; ++k) {
        panel(worker.local[at(matrix_.row[at(k)])], j) += matrix_.value[at(k)];
      }
    }
    update_[at(s)] = worker.pool.take(r, r);
    const Block update{update_[at(s)].data(), r, r, std::max(r, 1L)};
    clear_lower(update);
    for (const auto child : node.children) {
      add_child(tree_.nodes[at(child)], update_[at(child)], panel, update, node.width, worker);
      worker.pool.give(std::move(update_[at(child)]));
    }
    return update;
  }

 private:
  static void add_child(const Supernode& child, const Storage& from, Block panel, Block update,
                        long width, const Worker& worker) {
    const auto rows = static_cast<long>(child.rows.size());
    std::vector<std::int32_t> to(at(rows));
    for (long i = 0; i < rows; ++i) to[at(i)] = worker.local[at(child.rows[at(i)])];
    for (long j = 0; j < rows; ++j) {
      const long column = to[at(j)];
      double* target = column < width ? &panel(0, column) : &update(0, column - width) - width;
      const double* source = from.data() + j * rows;
      for (long i = j; i < rows; ++i) target[to[at(i)]] += source[i];
    }
  }

  const Tree& tree_;
  const Permuted& matrix_;
  std::vector<Storage> update_;
};

std::vector<Worker> workers_for(const Tree& tree) {
  std::vector<Worker> workers;
  for (int i = 0; i < thread_count(); ++i) workers.emplace_back(tree.order.size());
  return workers;
}

Block panel_of(const Supernode& node, double* data) {
  const long rows = node.width + static_cast<long>(node.rows.size());
  return {data, rows, node.width, rows};
}

}  // namespace

struct Factorization::Numeric {
  Numeric(const SparseMatrix& own_pattern)
      : own(std::in_place, own_pattern), tree(own->tree()), storage(tree.factor_size) {}
  explicit Numeric(const Tree& shared) : tree(shared), storage(shared.factor_size) {}

  void factorize(const SparseMatrix& a, double s, const SparseMatrix* b) {
    const auto matrix = permuted(tree, a, s, b);
    Fronts fronts(tree, matrix);
    auto workers = workers_for(tree);
    std::atomic<bool> definite{true};
    walk_up(tree, workers, [&](std::int32_t k, Worker& worker) {
      throw_if_interrupted();
      if (!definite) return;
      const auto& node = tree.nodes[at(k)];
      const Block panel = panel_of(node, storage.data() + node.place);
      const Block update = fronts.assemble(k, panel, worker);
      const Block top = panel.part(0, 0, node.width, node.width);
      const Block below = panel.part(node.width, 0, update.rows, node.width);
      if (!dense::cholesky(top)) definite = false;
      dense::solve_right(top, below, false);
      dense::subtract_symmetric(below, below, update);
    });
    if (!definite) {
      throw NumericalFailure("factorization: the matrix is not positive definite");
    }
  }

  std::optional<Symbolic> own;
  const Tree& tree;
  Storage storage;
};

Factorization::Factorization(const SparseMatrix& matrix)
    : numeric_(std::make_unique<Numeric>(matrix)) {
  numeric_->factorize(matrix, 0.0, nullptr);
}

Factorization::Factorization(const Symbolic& symbolic, const SparseMatrix& a, double s,
                             const SparseMatrix& b)
    : numeric_(std::make_unique<Numeric>(symbolic.tree())) {
  numeric_->factorize(a, s, &b);
}

Factorization::~Factorization() = default;
Factorization::Factorization(Factorization&&) noexcept = default;
Factorization& Factorization::operator=(Factorization&&) noexcept = default;

Eigen::MatrixXd Factorization::solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const {
  const auto& tree = numeric_->tree;
  const long columns = b.cols();
  Eigen::MatrixXd x(b.rows(), columns);
  for (Eigen::Index i = 0; i < b.rows(); ++i) x.row(i) = b.row(tree.order[at(i)]);
  const long n = x.rows();

  // Up: L y = b. Like the factorisation, each node hands the change of the rows below it up.
  std::vector<Eigen::MatrixXd> update(tree.nodes.size());
  std::vector<Worker> workers = workers_for(tree);
  walk_up(tree, workers, [&](std::int32_t s, Worker& worker) {
    const auto& node = tree.nodes[at(s)];
    const auto r = static_cast<long>(node.rows.size());
    for (std::int32_t j = 0; j < node.width; ++j) worker.local[at(node.first + j)] = j;
    for (long i = 0; i < r; ++i) {
      worker.local[at(node.rows[at(i)])] = static_cast<std::int32_t>(node.width + i);
    }
    auto& own = update[at(s)];
    own = Eigen::MatrixXd::Zero(r, columns);
    for (const auto child : node.children) {
      const auto& rows = tree.nodes[at(child)].rows;
      for (long c = 0; c < columns; ++c) {
        double* to_x = x.data() + c * n + node.first;
        double* to_own = own.data() + c * r - node.width;
        const double* from = update[at(child)].data() + c * static_cast<long>(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
          const auto place = worker.local[at(rows[i])];
          (place < node.width ? to_x : to_own)[place] += from[i];
        }
      }
      update[at(child)].resize(0, 0);
    }
    const Block panel = panel_of(node, numeric_->storage.data() + node.place);
    const Block mine{x.data() + node.first, node.width, columns, n};
    dense::solve_left(panel.part(0, 0, node.width, node.width), mine);
    dense::subtract_product(panel.part(node.width, 0, r, node.width), mine,
                            {own.data(), r, columns, std::max(r, 1L)});
  });

  // Down: Lᵀ x = y, parents first.
  const auto down = [&](std::int32_t s) {
    const auto& node = tree.nodes[at(s)];
    const auto r = static_cast<long>(node.rows.size());
    Eigen::MatrixXd above(r, columns);
    for (long c = 0; c < columns; ++c) {
      for (long i = 0; i < r; ++i) above(i, c) = x(node.rows[at(i)], c);
    }
    const Block panel = panel_of(node, numeric_->storage.data() + node.place);
    const Block mine{x.data() + node.first, node.width, columns, n};
    dense::subtract_transposed_product(panel.part(node.width, 0, r, node.width),
                                       {above.data(), r, columns, std::max(r, 1L)}, mine);
    dense::solve_left_transposed(panel.part(0, 0, node.width, node.width), mine);
  };
  for (auto s = tree.top.rbegin(); s != tree.top.rend(); ++s) down(*s);
  std::atomic<std::size_t> next{0};
  parallel_ranges(workers.size(), [&](std::size_t begin, std::size_t end) {
    for (auto w = begin; w < end; ++w) {
      for (auto k = next++; k < tree.subtrees.size(); k = next++) {
        const auto root = tree.subtrees[k];
        auto first = root;
        while (!tree.nodes[at(first)].children.empty()) {
          first = tree.nodes[at(first)].children.front();
        }
        for (auto s = root; s >= first; --s) down(s);
      }
    }
  });

  Eigen::MatrixXd result(b.rows(), columns);
  for (Eigen::Index i = 0; i < b.rows(); ++i) result.row(tree.order[at(i)]) = x.row(i);
  return result;
}

Inertia inertia(const Symbolic& symbolic, const SparseMatrix& a, double s, const SparseMatrix& b) {
  const auto& tree = symbolic.tree();
  const auto matrix = permuted(tree, a, s, &b);
  Fronts fronts(tree, matrix);
  auto workers = workers_for(tree);
  std::vector<std::int64_t> negative(tree.nodes.size(), 0);
  std::vector<double> smallest(tree.nodes.size(), 1.0);
  walk_up(tree, workers, [&](std::int32_t k, Worker& worker) {
    throw_if_interrupted();
    const auto& node = tree.nodes[at(k)];
    const long r = static_cast<long>(node.rows.size());
    const long rows = node.width + r;
    Storage own_panel = worker.pool.take(rows, node.width);
    const Block panel = panel_of(node, own_panel.data());
    clear_lower(panel);
    const Block update = fronts.assemble(k, panel, worker);
    const Block top = panel.part(0, 0, node.width, node.width);
    const Block below = panel.part(node.width, 0, r, node.width);
    smallest[at(k)] = dense::ldlt(top);
    dense::solve_right(top, below, true);  // L D
    Storage scaled = worker.pool.take(r, node.width);
    const Block with_d{scaled.data(), r, node.width, std::max(r, 1L)};
    for (long j = 0; j < node.width; ++j) {
      if (top(j, j) < 0.0) ++negative[at(k)];
      for (long i = 0; i < r; ++i) {
        with_d(i, j) = below(i, j);
        below(i, j) /= top(j, j);
      }
    }
    dense::subtract_symmetric(with_d, below, update);
    worker.pool.give(std::move(scaled));
    worker.pool.give(std::move(own_panel));
  });
  Inertia result{.smallest_pivot = *std::min_element(smallest.begin(), smallest.end())};
  for (const auto count : negative) result.negative += count;
  result.positive = static_cast<Eigen::Index>(tree.order.size()) - result.negative;
  return result;
}

}  // namespace chladni::fem
