// The factor by parts of the tree: what CHOLMOD is given, where the panels lie, and the loop over
// the subtrees.
#pragma once

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "dense/blocks.h"
#include "fem/factor/elimination_tree.h"
#include "fem/factor/storage.h"
#include "host/parallel.h"

namespace chladni::fem {

/// Makes tree.parts from tree.subtrees and tree.top, and places the panels of their nodes.
void choose_parts(Symbolic::Tree& tree);

/// Doubles of memory that the Cholesky factorisation needs besides the panels and the matrix, at
/// most.
[[nodiscard]] std::int64_t work_of_parts(const Symbolic::Tree& tree);

struct Factorization::Numeric {
  explicit Numeric(const SparseMatrix& own_pattern)
      : Numeric(std::make_shared<const Symbolic>(own_pattern)) {}
  explicit Numeric(std::shared_ptr<const Symbolic> kept)
      : own(std::move(kept)), tree(own->tree()), parts(tree.parts.size()) {}
  explicit Numeric(const Symbolic::Tree& shared) : tree(shared), parts(tree.parts.size()) {}

  void factorize(const SparseMatrix& a, double s, const SparseMatrix* b);
  /// The columns of L of a node: its own rows, then those below; L stands on and below the
  /// diagonal.
  [[nodiscard]] dense::Block panel(const Supernode& node) const {
    const long rows = node.width + static_cast<long>(node.rows.size());
    return {parts[static_cast<std::size_t>(node.part)].data() + node.place, rows, node.width, rows};
  }

  std::shared_ptr<const Symbolic> own;  ///< null: the tree is somebody else's
  const Symbolic::Tree& tree;
  std::vector<Storage> parts;
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
