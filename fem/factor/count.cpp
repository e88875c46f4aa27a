// Counts eigenvalues by multifrontal LDLᵀ (Duff and Reid 1983) on the tree of supernodes. Each
// supernode assembles a dense front from the matrix and its children's update blocks, eliminates
// its columns with BLAS, and passes its own update block to its parent. First the cores work on
// different subtrees; then all cores work on the blocks of one front at a time. BLAS itself stays
// on one thread. Sums are in a fixed order, so the bits do not depend on which core does what.

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/index.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "fem/factor/fronts.h"
#include "fem/factor/parts.h"

namespace chladni::fem {
namespace {

using Tree = Symbolic::Tree;

// Calls work(node, thread, team) for every node, after its children. The subtrees come first, one
// thread per subtree. The nodes above the subtrees follow, all threads on one node.
template <typename NodeWork>
void walk_up(const Tree& tree, const NodeWork& work) {
  const dense::OneBlasThread one_thread;
  each_subtree(tree, [&](std::size_t k, std::size_t thread) {
    const auto root = tree.subtrees[k];
    for (auto s = first_descendant(tree, root); s <= root; ++s) {
      throw_if_interrupted();
      work(s, thread, Team::one);
    }
  });
  for (const auto s : tree.top) {
    throw_if_interrupted();
    work(s, std::size_t{0}, Team::all);
  }
}

std::vector<Worker> workers_for(const Tree& tree) {
  std::vector<Worker> workers;
  for (int i = 0; i < tree.threads; ++i) workers.emplace_back(tree);
  return workers;
}

// The largest entry of A or s B in each row, in the order of elimination.
std::vector<double> largest_entries(const Tree& tree, const SparseMatrix& a, double s,
                                    const SparseMatrix& b) {
  std::vector<double> largest(tree.order.size(), 0.0);
  const auto note = [&](const SparseMatrix& matrix, double factor) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
      auto& on_column = largest[at(tree.position[at(c)])];
      for (SparseMatrix::InnerIterator entry(matrix, c); entry; ++entry) {
        auto& on_row = largest[at(tree.position[at(entry.row())])];
        const double size = std::abs(factor * entry.value());
        on_row = std::max(on_row, size);
        on_column = std::max(on_column, size);
      }
    }
  };
  note(a, 1.0);
  note(b, s);
  return largest;
}

// The counts of pivot signs, and the figures that say whether the elimination can be trusted.
Inertia told_by(const Pivots& pivots, const std::vector<std::vector<double>>& spread,
                const std::vector<double>& entries) {
  Inertia result{.smallest_pivot = 1.0, .growth = 1.0};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    double diagonal = entries[i];
    for (const auto& of_thread : spread) diagonal = std::max(diagonal, of_thread[i]);
    if (diagonal == 0.0) diagonal = 1.0;  // an empty row: its pivot is 0
    const double d = pivots.value[i];
    const double largest = std::max({std::abs(d), pivots.largest[i], diagonal});
    ++(d < 0.0 ? result.negative : result.positive);
    result.smallest_pivot = std::min(result.smallest_pivot, std::abs(d) / largest);
    result.growth = std::max(result.growth, diagonal / std::max(entries[i], 1e-300));
  }
  return result;
}

}  // namespace

Inertia inertia(const Symbolic& symbolic, const SparseMatrix& a, double s, const SparseMatrix& b) {
  const auto& tree = symbolic.tree();
  const auto matrix = permuted(tree, a, s, &b);
  Fronts fronts(tree, matrix);
  auto workers = workers_for(tree);
  Pivots pivots(tree.order.size());
  std::vector<std::vector<double>> spread(workers.size(), std::vector<double>(tree.order.size()));
  std::atomic<bool> sound{true};
  walk_up(tree, [&](std::int32_t k, std::size_t thread, Team team) {
    if (!sound) return;
    const auto& node = tree.nodes[at(k)];
    auto& worker = workers[thread];
    if (worker.panel.data() == nullptr) {
      worker.panel = Storage(tree.largest_panel);
      worker.scaled = Storage(tree.tallest_front * kStripWidth);
    }
    std::fill_n(worker.panel.data(), panel_size(node), 0.0);
    const auto update = fronts.assemble(k, worker.panel.data(), worker);
    if (!eliminate_indefinite(node, worker.panel.data(), update, worker.scaled.data(), team, pivots,
                              spread[thread])) {
      sound = false;
    }
  });
  auto result = told_by(pivots, spread, largest_entries(tree, a, s, b));
  if (!sound) result.smallest_pivot = 0.0;
  return result;
}

}  // namespace chladni::fem
