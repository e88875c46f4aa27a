// Multifrontal factorisation (Duff and Reid 1983) on the elimination tree: each node assembles a
// dense front from the matrix and its children's update blocks, eliminates its columns with BLAS,
// and hands its own update block up. Subtrees run on both cores; sums are in a fixed order, so the
// bits do not depend on which core does what.
#include "fem/multifrontal.h"

#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "base/interrupt.h"
#include "fem/fronts.h"

namespace chladni::fem {
namespace {

using Tree = Symbolic::Tree;
std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Calls work(node, worker) for every node after its children: the subtrees on all threads, then
// the nodes above them with threads inside BLAS.
template <typename NodeWork>
void walk_up(const Tree& tree, const NodeWork& work) {
  std::vector<Worker> workers;
  for (int i = 0; i < tree.threads; ++i) workers.emplace_back(tree);
  each_subtree(tree, [&](std::size_t k, std::size_t thread) {
    const auto root = tree.subtrees[k];
    for (auto s = first_descendant(tree, root); s <= root; ++s) {
      throw_if_interrupted();
      work(s, workers[thread]);
    }
  });
  set_blas_threads(tree.threads);
  for (const auto s : tree.top) {
    throw_if_interrupted();
    work(s, workers.front());
  }
  set_blas_threads(1);
}

}  // namespace

void Factorization::Numeric::factorize(const SparseMatrix& a, double s, const SparseMatrix* b) {
  const auto matrix = permuted(tree, a, s, b);
  Fronts fronts(tree, matrix);
  std::atomic<bool> definite{true};
  walk_up(tree, [&](std::int32_t k, Worker& worker) {
    if (!definite) return;
    const auto& node = tree.nodes[at(k)];
    const auto update = fronts.assemble(k, panel(node), worker);
    if (!eliminate(node, panel(node), update)) definite = false;
  });
  if (!definite) throw NumericalFailure("factorization: the matrix is not positive definite");
}

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

Inertia inertia(const Symbolic& symbolic, const SparseMatrix& a, double s, const SparseMatrix& b) {
  const auto& tree = symbolic.tree();
  const auto matrix = permuted(tree, a, s, &b);
  Fronts fronts(tree, matrix);
  std::vector<Pivots> pivots(tree.nodes.size());
  walk_up(tree, [&](std::int32_t k, Worker& worker) {
    const auto& node = tree.nodes[at(k)];
    if (worker.panel.data() == nullptr) {
      worker.panel = Storage(tree.largest_panel);
      worker.scaled = Storage(tree.tallest_front * kStripWidth);
    }
    std::fill_n(worker.panel.data(), panel_size(node), 0.0);
    const auto update = fronts.assemble(k, worker.panel.data(), worker);
    pivots[at(k)] = eliminate_indefinite(node, worker.panel.data(), update, worker.scaled.data());
  });
  Inertia result{.smallest_pivot = 1.0};
  for (const auto& p : pivots) {
    result.negative += p.negative;
    result.smallest_pivot = std::min(result.smallest_pivot, p.smallest);
  }
  result.positive = static_cast<Eigen::Index>(tree.order.size()) - result.negative;
  return result;
}

}  // namespace chladni::fem
