// The door to CHOLMOD (SuiteSparse): the symbolic analysis, and the Cholesky factor of one part of
// the tree of supernodes.
#pragma once

#include <cstdint>
#include <vector>

#include "base/arrays.h"
#include "fem/factor/elimination_tree.h"

namespace chladni::fem {

/// The supernodes of a graph of groups, by CHOLMOD's symbolic analysis. Groups are numbered in the
/// order of elimination, in which children come before their parents.
struct GroupSupernodes {
  std::vector<std::int32_t> order;  ///< new -> old group
  std::vector<std::int32_t> first;  ///< supernode -> its first group; supernodes + 1 entries
  std::vector<std::int32_t> start;  ///< supernode -> where its `rows` begin; supernodes + 1 entries
  std::vector<std::int32_t> rows;   ///< the groups of each front, ascending: its own, those below
};
/// @param order  new -> old group, as `nested_dissection` gives it; CHOLMOD changes it only to an
///               equivalent one, in which each subtree is contiguous
/// @throws OutOfResources
[[nodiscard]] GroupSupernodes supernodes(const QuotientGraph& graph,
                                         const std::vector<std::int32_t>& order);

/// A part of the tree of supernodes in numbers of its own: the part's columns come first, then its
/// border, which is the rows of later parts that it reaches.
struct PartShape {
  std::int32_t columns = 0, border = 0;
  std::vector<std::int32_t> first;  ///< supernode -> its first column
  std::vector<std::int64_t> start;  ///< supernode -> where its `rows` begin; supernodes + 1 entries
  std::vector<std::int32_t> rows;   ///< of each front, ascending: its own columns, those below
  std::vector<std::int64_t> place;  ///< supernode -> its panel (rows × width, column-major)
  std::int64_t panels = 0;          ///< doubles of all panels together
};

/// The columns of a part of a symmetric matrix, lower triangle. Column j holds `count[j]` entries
/// from entry `start[j]` of `row` and `value` on, in any order. The border's columns are not given.
struct PartMatrix {
  std::vector<std::int32_t> start, count;
  std::int32_t* row = nullptr;
  double* value = nullptr;
  std::int32_t room = 0;  ///< an entry of `row` and `value` that no column uses
};

/// Doubles that `factorise` works with besides the panels and the border's block.
[[nodiscard]] std::int64_t work_size(const PartShape& shape);

/// Eliminates the part's columns: the panels become columns of L, and the lower triangle of the
/// border's block (border × border, column-major, right after the panels) becomes minus what the
/// part subtracts from later parts. Runs in the calling thread; BLAS must be on one thread. Ctrl-C
/// has to wait.
/// @param values     panels + border² zeros
/// @param long_from  size in doubles from which CHOLMOD's 64-bit indices are used
/// @return  false where the matrix is not positive definite
/// @throws OutOfResources
[[nodiscard]] bool factorise(const PartShape& shape, const PartMatrix& matrix, double* values,
                             std::int64_t long_from = std::int64_t{1} << 31U);

/// The numbers of negative and positive pivots of CHOLMOD's own LDLᵀ (simplicial, in an order of
/// its own), as a second opinion on `inertia`. It takes some twenty times as long.
/// @param matrix  n×n, lower triangle
/// @throws NumericalFailure  a pivot is 0
/// @throws OutOfResources
[[nodiscard]] Inertia second_inertia(const SparseMatrix& matrix);

}  // namespace chladni::fem
