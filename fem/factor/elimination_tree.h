// The order of elimination of a sparse symmetric matrix, and the dense fronts that follow from this
// order.
#pragma once

#include <cstdint>
#include <vector>

#include "base/arrays.h"
#include "fem/factor/factorization.h"

namespace chladni::fem {

/// Columns of a front that are eliminated together and stored together.
inline constexpr long kStripWidth = 128;

/// A supernode: consecutive columns with one row structure. Its dense front has
/// width + rows.size() rows.
struct Supernode {
  std::int32_t first = 0;  ///< column, in the order of elimination
  std::int32_t width = 0;
  std::int32_t parent = -1;        ///< −1: a root
  std::vector<std::int32_t> rows;  ///< below the columns, ascending, in the order of elimination
  std::vector<std::int32_t> children;
  std::int64_t place = 0;  ///< where its panel starts in the storage of its part of the factor
  std::int32_t part = 0;
  std::int8_t parity = 0;  ///< its depth below its root, modulo 2
  bool detached = false;   ///< root of a subtree that has a parent: its update block waits
                           ///< outside the stacks
  double flops = 0.0;      ///< for its own front
  double subtree_flops = 0.0;
};

/// Size of a node's panel in doubles while eigenvalues are counted. The panel holds strips of the
/// node's columns; each strip starts at its own diagonal.
[[nodiscard]] std::int64_t panel_size(const Supernode& node);

/// A part of the tree that CHOLMOD factorises in one call: a subtree, or all nodes above the
/// subtrees. The panels of its nodes lie in one storage, each with all its rows.
struct Part {
  std::vector<std::int32_t> nodes;
  std::int32_t columns = 0;
  std::vector<std::int32_t> border;  ///< rows of other parts that it reaches, ascending, in the
                                     ///< order of elimination
  std::int64_t panels = 0;           ///< doubles
};

struct Symbolic::Tree {
  std::vector<std::int32_t> order;      ///< new -> old degree of freedom
  std::vector<std::int32_t> position;   ///< old -> new
  std::vector<Supernode> nodes;         ///< children before parents
  std::int64_t factor_size = 0;         ///< doubles of all parts
  std::int64_t largest_panel = 0;       ///< doubles
  std::int64_t tallest_front = 0;       ///< rows
  std::int64_t stack_size[2] = {0, 0};  ///< doubles of waiting update blocks per thread, at most,
                                        ///< by the parity of their depth
  std::int64_t detached_size = 0;       ///< doubles of the update blocks outside the stacks
  double flops = 0.0;
  double entries = 0.0;            ///< of the pattern
  double entries_of_factor = 0.0;  ///< on and below the diagonal
  int threads = 1;                 ///< number of threads that the subtrees were chosen for
  std::vector<std::int32_t>
      subtrees;  ///< roots of subtrees that threads can work on at once, heaviest first
  std::vector<std::int32_t> top;  ///< the nodes above them, children before parents
  std::vector<Part> parts;        ///< the subtrees, then the nodes above where there are any
};

/// The first node of the subtree of `root`. The nodes from this one to `root` are the subtree.
[[nodiscard]] std::int32_t first_descendant(const Symbolic::Tree& tree, std::int32_t root);

/// A graph of groups: degrees of freedom with one structure form one group. The graph is a third as
/// long.
struct QuotientGraph {
  std::vector<std::int32_t> first;  ///< group -> its first degree of freedom; groups + 1 entries
  std::vector<std::int32_t> start;  ///< adjacency without loops, both directions
  std::vector<std::int32_t> neighbour;
};
[[nodiscard]] QuotientGraph quotient_graph(const SparseMatrix& pattern);

/// Number of groups above which METIS takes about a second or more, too long for Ctrl-C to wait.
inline constexpr std::size_t kLargeGraph = 50'000;

/// The order of the groups (new -> old) by nested dissection. A graph of `large` groups or more
/// goes to a worker, which Ctrl-C ends within 0.2 s.
/// @throws Interrupted, WorkerDied, OutOfResources
[[nodiscard]] std::vector<std::int32_t> nested_dissection(const QuotientGraph& graph,
                                                          std::size_t large = kLargeGraph);

}  // namespace chladni::fem
