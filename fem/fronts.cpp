#include "fem/fronts.h"

#include <algorithm>

namespace chladni::fem {
namespace {

using Tree = Symbolic::Tree;
using dense::Block;
std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Calls visit(column, row, value) for every entry of A + s B, in the order of elimination.
template <typename Visit>
void each_entry(const Tree& tree, const SparseMatrix& a, double s, const SparseMatrix* b,
                const Visit& visit) {
  for (Eigen::Index c = 0; c < a.cols(); ++c) {
    const auto pc = tree.position[at(c)];
    const auto tell = [&](auto r, double value) {
      const auto pr = tree.position[at(r)];
      visit(std::min(pc, pr), std::max(pc, pr), value);
    };
    SparseMatrix::InnerIterator x(a, c);
    if (b != nullptr) {
      for (SparseMatrix::InnerIterator y(*b, c); y; ++y) {
        for (; x && x.row() < y.row(); ++x) tell(x.row(), x.value());
        const bool both = x && x.row() == y.row();
        tell(y.row(), s * y.value() + (both ? x.value() : 0.0));
        if (both) ++x;
      }
    }
    for (; x; ++x) tell(x.row(), x.value());
  }
}

// Where the rows of a child's update block go: runs of neighbours are added as vectors.
struct Destination {
  struct Run {
    std::int32_t first, last, to;  // rows [first, last) of the child, row of the front
  };
  std::vector<std::int32_t> row;
  std::vector<Run> runs;
};

void find_destination(const Supernode& child, const Worker& worker, Destination& d) {
  d.row.resize(child.rows.size());
  d.runs.clear();
  for (std::size_t i = 0; i < child.rows.size(); ++i) {
    const auto to = worker.local[at(child.rows[i])];
    const auto index = static_cast<std::int32_t>(i);
    d.row[i] = to;
    if (d.runs.empty() || to != d.row[i - 1] + 1) d.runs.push_back({index, index, to});
    ++d.runs.back().last;
  }
}

void add_column(const Destination& d, long j, std::size_t first_run, const double* source,
                double* target) {
  if (d.row.size() < 8 * d.runs.size()) {  // short runs
    for (auto i = at(j); i < d.row.size(); ++i) target[d.row[i]] += source[i];
    return;
  }
  for (auto k = first_run; k < d.runs.size(); ++k) {
    const auto& run = d.runs[k];
    const auto begin = std::max<long>(run.first, j);
    double* to = target + run.to + (begin - run.first);
    const double* from = source + begin;
    const long length = run.last - begin;
    for (long i = 0; i < length; ++i) to[i] += from[i];
  }
}

void add_child(const Supernode& child, const double* from, const Supernode& node, double* panel,
               Block update, const Destination& d) {
  const auto rows = static_cast<long>(child.rows.size());
  std::size_t run = 0;
  for (long j = 0; j < rows; ++j) {
    while (d.runs[run].last <= j) ++run;
    const long column = d.row[at(j)];
    double* target = nullptr;
    if (column < node.width) {
      const Block own = strip(node, panel, column / kStripWidth);
      const long before = column - column % kStripWidth;
      target = &own(0, column - before) - before;
    } else {
      target = &update(0, column - node.width) - node.width;
    }
    add_column(d, j, run, from + j * rows, target);
  }
}

std::int64_t update_size(const Supernode& node) {
  const auto r = static_cast<std::int64_t>(node.rows.size());
  return r * r;
}

// Takes what strip p eliminated out of the strips after it and out of the update block: `left` is
// below itself or below times D.
void spread(const Supernode& node, double* panel, long p, Block left, Block below, Block update) {
  for (long q = p + 1; q < strip_count(node); ++q) {
    const Block later = strip(node, panel, q);
    const long from = (q - p - 1) * kStripWidth;
    dense::subtract_product_transposed(left.part(from, 0, later.rows, left.columns),
                                       below.part(from, 0, later.columns, below.columns), later);
  }
  const long from = below.rows - update.rows;
  dense::subtract_symmetric(left.part(from, 0, update.rows, left.columns),
                            below.part(from, 0, update.rows, below.columns), update);
}

}  // namespace

Permuted permuted(const Tree& tree, const SparseMatrix& a, double s, const SparseMatrix* b) {
  Permuted p{std::vector<std::int64_t>(tree.order.size() + 1, 0), {}, {}};
  each_entry(tree, a, s, b, [&](auto column, auto, double) { ++p.start[at(column) + 1]; });
  for (std::size_t i = 0; i < tree.order.size(); ++i) p.start[i + 1] += p.start[i];
  p.row.resize(at(p.start.back()));
  p.value.resize(p.row.size());
  auto next = p.start;
  each_entry(tree, a, s, b, [&](auto column, auto row, double value) {
    const auto k = at(next[at(column)]++);
    p.row[k] = row;
    p.value[k] = value;
  });
  return p;
}

Block strip(const Supernode& node, double* panel, long p) {
  const long rows = node.width + static_cast<long>(node.rows.size());
  const long before = p * kStripWidth;
  const long skipped = before * rows - kStripWidth * kStripWidth * (p * (p - 1) / 2);
  return {panel + skipped, rows - before, std::min(kStripWidth, node.width - before),
          rows - before};
}

Worker::Worker(const Tree& tree)
    : local(tree.order.size(), -1), stacks{Stack(tree.stack_size[0]), Stack(tree.stack_size[1])} {}

Fronts::Fronts(const Tree& tree, const Permuted& matrix)
    : tree_(tree), matrix_(matrix), update_(tree.nodes.size()), detached_(tree.nodes.size()) {}

Block Fronts::new_update(std::int32_t s, Worker& worker) {
  const auto& node = tree_.nodes[at(s)];
  const auto r = static_cast<long>(node.rows.size());
  if (node.detached) {
    detached_[at(s)] = Storage(update_size(node));
    update_[at(s)] = detached_[at(s)].data();
  } else {
    update_[at(s)] = worker.stacks[node.parity].push(update_size(node));
  }
  const Block update{update_[at(s)], r, r, std::max(r, 1L)};
  for (long j = 0; j < r; ++j) std::fill_n(&update(j, j), r - j, 0.0);
  return update;
}

void Fronts::give_back(std::int32_t s, Worker& worker) {
  const auto& node = tree_.nodes[at(s)];
  if (node.detached) {
    detached_[at(s)] = {};
  } else {
    worker.stacks[node.parity].pop(update_size(node));
  }
}

Block Fronts::assemble(std::int32_t s, double* panel, Worker& worker) {
  const auto& node = tree_.nodes[at(s)];
  for (std::int32_t j = 0; j < node.width; ++j) worker.local[at(node.first + j)] = j;
  for (std::size_t i = 0; i < node.rows.size(); ++i) {
    worker.local[at(node.rows[i])] = node.width + static_cast<std::int32_t>(i);
  }
  for (long p = 0; p < strip_count(node); ++p) {
    const Block own = strip(node, panel, p);
    for (long j = 0; j < own.columns; ++j) {
      double* target = &own(0, j) - p * kStripWidth;
      const auto column = at(node.first + p * kStripWidth + j);
      for (auto k = matrix_.start[column]; k < matrix_.start[column + 1]; ++k) {
        target[worker.local[at(matrix_.row[at(k)])]] += matrix_.value[at(k)];
      }
    }
  }
  const Block update = new_update(s, worker);
  Destination destination;
  for (const auto child : node.children) {
    find_destination(tree_.nodes[at(child)], worker, destination);
    add_child(tree_.nodes[at(child)], update_[at(child)], node, panel, update, destination);
  }
  for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
    give_back(*child, worker);
  }
  return update;
}

bool eliminate(const Supernode& node, double* panel, Block update) {
  for (long p = 0; p < strip_count(node); ++p) {
    const Block own = strip(node, panel, p);
    const Block top = own.part(0, 0, own.columns, own.columns);
    const Block below = own.part(own.columns, 0, own.rows - own.columns, own.columns);
    if (!dense::cholesky(top)) return false;
    dense::solve_right(top, below, false);
    spread(node, panel, p, below, below, update);
  }
  return true;
}

Pivots eliminate_indefinite(const Supernode& node, double* panel, Block update, double* scaled) {
  Pivots pivots;
  for (long p = 0; p < strip_count(node); ++p) {
    const Block own = strip(node, panel, p);
    const Block top = own.part(0, 0, own.columns, own.columns);
    const Block below = own.part(own.columns, 0, own.rows - own.columns, own.columns);
    pivots.smallest = std::min(pivots.smallest, dense::ldlt(top));
    if (pivots.smallest == 0.0) return pivots;
    dense::solve_right(top, below, true);  // L D
    const Block with_d{scaled, below.rows, below.columns, std::max(below.rows, 1L)};
    for (long j = 0; j < own.columns; ++j) {
      const double d = top(j, j);
      if (d < 0.0) ++pivots.negative;
      for (long i = 0; i < below.rows; ++i) {
        with_d(i, j) = below(i, j);
        below(i, j) /= d;
      }
    }
    spread(node, panel, p, with_d, below, update);
  }
  return pivots;
}

}  // namespace chladni::fem
