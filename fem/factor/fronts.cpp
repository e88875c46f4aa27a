#include "fem/factor/fronts.h"

#include <algorithm>

#include "base/index.h"
#include "base/interrupt.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

using Tree = Symbolic::Tree;
using dense::Block;

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

// The rows of the front to which a child's update block is added. Runs of consecutive rows are
// added as vectors.
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

// Calls work(i) for all i < count and answers Ctrl-C before each call. `flops` is the cost of all
// calls together.
template <typename Work>
void each_block(Team team, long count, double flops, const Work& work) {
  constexpr double kWorthThreads = 2e7;  // a thread costs about 30 µs to start
  const auto step = [&](std::size_t i) {
    throw_if_interrupted();
    work(static_cast<long>(i));
  };
  if (team == Team::all && flops > kWorthThreads) return parallel_tasks(at(count), step);
  for (long i = 0; i < count; ++i) step(at(i));
}

long blocks_in(long size, long block) { return (size + block - 1) / block; }

// Calls work(block of rows, number of the block) for the rows of `below`.
constexpr long kRows = 512;
template <typename Work>
void each_row_block(Team team, Block below, const Work& work) {
  const double flops = double(below.rows) * double(below.columns) * double(below.columns);
  each_block(team, blocks_in(below.rows, kRows), flops, [&](long k) {
    const long first = k * kRows;
    work(below.part(first, 0, std::min(kRows, below.rows - first), below.columns), k);
  });
}

// Subtracts the contribution of strip p from the later strips and from the update block. `left` is
// `below` times D.
void spread_strip(const Supernode& node, double* panel, long p, Block left, Block below,
                  Block update, Team team) {
  constexpr long kColumns = 192;
  const long strips = strip_count(node) - p - 1;
  const long from = below.rows - update.rows;
  const double flops = double(below.rows) * double(below.rows) * double(below.columns);
  each_block(team, strips + blocks_in(update.rows, kColumns), flops, [&](long k) {
    if (k < strips) {
      const Block later = strip(node, panel, p + 1 + k);
      const long row = k * kStripWidth;
      return dense::subtract_product_transposed(left.part(row, 0, later.rows, left.columns),
                                                below.part(row, 0, later.columns, below.columns),
                                                later);
    }
    const long column = (k - strips) * kColumns;
    const long width = std::min(kColumns, update.rows - column);
    dense::subtract_product_transposed(
        left.part(from + column, 0, update.rows - column, left.columns),
        below.part(from + column, 0, width, below.columns),
        update.part(column, column, update.rows - column, width));
  });
}

// The row in the order of elimination that row i of a front stands for.
std::size_t row_of(const Supernode& node, long i) {
  return at(i < node.width ? node.first + i : node.rows[at(i - node.width)]);
}

// Raises `spread` to l²|d| of the negative pivots in one strip. The strip starts at row `row` of
// the front.
void note_spread(const Supernode& node, Block own, long row, std::vector<double>& spread) {
  for (long k = 0; k < own.columns; ++k) {
    const double d = own(k, k);
    if (!(d < 0.0)) continue;
    auto& diagonal = spread[row_of(node, row + k)];
    diagonal = std::max(diagonal, -d);
    for (long i = k + 1; i < own.rows; ++i) {
      auto& on_row = spread[row_of(node, row + i)];
      on_row = std::max(on_row, -d * own(i, k) * own(i, k));
    }
  }
}

}  // namespace

Permuted permuted(const Tree& tree, const SparseMatrix& a, double s, const SparseMatrix* b,
                  std::size_t spare) {
  Permuted p{std::vector<std::int64_t>(tree.order.size() + 1, 0), {}, {}};
  each_entry(tree, a, s, b, [&](auto column, auto, double) { ++p.start[at(column) + 1]; });
  for (std::size_t i = 0; i < tree.order.size(); ++i) p.start[i + 1] += p.start[i];
  p.row.resize(at(p.start.back()) + spare);
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

bool eliminate_indefinite(const Supernode& node, double* panel, Block update, double* scaled,
                          Team team, Pivots& pivots, std::vector<double>& spread) {
  std::vector<double> largest;  // per block of rows
  for (long p = 0; p < strip_count(node); ++p) {
    const Block own = strip(node, panel, p);
    const Block top = own.part(0, 0, own.columns, own.columns);
    const Block below = own.part(own.columns, 0, own.rows - own.columns, own.columns);
    const Block with_d{scaled, below.rows, below.columns, std::max(below.rows, 1L)};
    const auto first = at(node.first + p * kStripWidth);
    if (!dense::ldlt(top, &pivots.largest[first])) return false;
    largest.assign(at(blocks_in(below.rows, kRows) * own.columns), 0.0);
    each_row_block(team, below, [&](Block rows, long k) {
      dense::eliminate_below(top, rows, with_d.part(k * kRows, 0, rows.rows, rows.columns),
                             &largest[at(k * own.columns)]);
    });
    for (std::size_t k = 0; k < largest.size(); ++k) {
      auto& of_column = pivots.largest[first + k % at(own.columns)];
      of_column = std::max(of_column, largest[k]);
    }
    for (long k = 0; k < own.columns; ++k) pivots.value[first + at(k)] = top(k, k);
    note_spread(node, own, p * kStripWidth, spread);
    spread_strip(node, panel, p, with_d, below, update, team);
  }
  return true;
}

}  // namespace chladni::fem
