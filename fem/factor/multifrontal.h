// The factor's storage, and the loop over the subtrees.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "fem/factor/elimination_tree.h"
#include "fem/factor/storage.h"

namespace chladni::fem {

struct Factorization::Numeric {
  explicit Numeric(const SparseMatrix& own_pattern)
      : own(std::in_place, own_pattern), tree(own->tree()), storage(tree.factor_size, true) {}
  explicit Numeric(const Symbolic::Tree& shared)
      : tree(shared), storage(shared.factor_size, true) {}

  void factorize(const SparseMatrix& a, double s, const SparseMatrix* b);
  [[nodiscard]] double* panel(const Supernode& node) const { return storage.data() + node.place; }

  std::optional<Symbolic> own;
  const Symbolic::Tree& tree;
  Storage storage;
};

/// Calls work(k, thread) for every subtree k, on tree.threads threads. The thread that works on a
/// subtree is not fixed, so the sums must not depend on the thread.
template <typename Work>
void each_subtree(const Symbolic::Tree& tree, const Work& work) {
  std::atomic<std::size_t> next{0};
  parallel_ranges(static_cast<std::size_t>(tree.threads), [&](std::size_t begin, std::size_t end) {
    for (auto thread = begin; thread < end; ++thread) {
      for (auto k = next++; k < tree.subtrees.size(); k = next++) work(k, thread);
    }
  });
}

}  // namespace chladni::fem
