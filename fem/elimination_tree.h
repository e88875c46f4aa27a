// The order of elimination of a sparse symmetric matrix and the dense blocks that follow from it.
#pragma once

#include <cstdint>
#include <vector>

#include "base/arrays.h"
#include "fem/factorization.h"

namespace chladni::fem {

/// Consecutive columns with one row structure: a dense front of width + rows.size() rows.
struct Supernode {
  std::int32_t first = 0;           ///< column, in the order of elimination
  std::int32_t width = 0;
  std::int32_t parent = -1;         ///< −1: a root
  std::vector<std::int32_t> rows;   ///< below the columns, ascending, in the order of elimination
  std::vector<std::int32_t> children;
  std::int64_t place = 0;           ///< of its (width + rows)×width panel in the factor's storage
  double flops = 0.0;               ///< of its own front
  double subtree_flops = 0.0;
};

struct Symbolic::Tree {
  std::vector<std::int32_t> order;     ///< new -> old degree of freedom
  std::vector<std::int32_t> position;  ///< old -> new
  std::vector<Supernode> nodes;        ///< children before parents
  std::int64_t factor_size = 0;        ///< doubles
  double largest_stack = 0.0;          ///< doubles of pending update blocks, at most
  double flops = 0.0;
  std::vector<std::int32_t> subtrees;  ///< roots of subtrees that can be worked on at once, heaviest first
  std::vector<std::int32_t> top;       ///< the nodes above them, children before parents
};

/// Degrees of freedom with one structure taken together, for a graph a third as long.
struct QuotientGraph {
  std::vector<std::int32_t> first;     ///< group -> its first degree of freedom; groups + 1 entries
  std::vector<std::int32_t> start;     ///< adjacency without loops, both directions
  std::vector<std::int32_t> neighbour;
};
[[nodiscard]] QuotientGraph quotient_graph(const SparseMatrix& pattern);

/// new -> old group, by nested dissection.
[[nodiscard]] std::vector<std::int32_t> nested_dissection(const QuotientGraph& graph);

}  // namespace chladni::fem
