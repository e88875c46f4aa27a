// The dense fronts of the multifrontal method, with which eigenvalues are counted: storage,
// assembly and elimination.
#pragma once

#include <vector>

#include "dense/blocks.h"
#include "fem/factor/elimination_tree.h"
#include "fem/factor/storage.h"

namespace chladni::fem {

/// A + s B in the order of elimination. Each column holds its entries on and below the diagonal,
/// unsorted. `spare` more entries at the end are free.
struct Permuted {
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> row;
  std::vector<double> value;
};
/// @param b  may be null. Cost: linear, twice over the entries.
[[nodiscard]] Permuted permuted(const Symbolic::Tree& tree, const SparseMatrix& a, double s,
                                const SparseMatrix* b, std::size_t spare = 0);

/// Strip `p` of the columns that a node eliminates, with the rows from the strip's diagonal down.
/// Strips follow each other in storage, so that little of the upper triangle is stored.
[[nodiscard]] dense::Block strip(const Supernode& node, double* panel, long p);
[[nodiscard]] inline long strip_count(const Supernode& node) {
  return (node.width + kStripWidth - 1) / kStripWidth;
}

/// The data that one thread needs besides the tree.
struct Worker {
  explicit Worker(const Symbolic::Tree& tree);
  std::vector<std::int32_t> local;  ///< row in the order of elimination -> row of the front
  Stack stacks[2];                  ///< of update blocks, by the parity of the node's depth
  Storage panel, scaled;            ///< for one front, where no factor is kept
};

/// Assembles fronts from the matrix and the children's update blocks. An update block waits on a
/// stack until the parent takes it. The update blocks of the roots of subtrees wait in separate
/// storage.
class Fronts {
 public:
  Fronts(const Symbolic::Tree& tree, const Permuted& matrix);

  /// Assembles the front of node s into `panel` (panel_size zeros) and into the returned update
  /// block. Only the lower triangle of the update block has meaning.
  dense::Block assemble(std::int32_t s, double* panel, Worker& worker);

 private:
  dense::Block new_update(std::int32_t s, Worker& worker);
  void give_back(std::int32_t s, Worker& worker);

  const Symbolic::Tree& tree_;
  const Permuted& matrix_;
  std::vector<double*> update_;
  std::vector<Storage> detached_;
};

/// The threads that work on one front.
enum class Team {
  one,  ///< this thread
  all   ///< all threads; the blocks do not depend on the number of threads
};

/// The pivots of LDLᵀ, by rows in the order of elimination.
struct Pivots {
  explicit Pivots(std::size_t rows) : value(rows), largest(rows) {}
  std::vector<double> value;    ///< D; 0 where the elimination stopped
  std::vector<double> largest;  ///< the largest entry of the column on and below the pivot
};
/// Eliminates the node's columns by LDLᵀ without exchanges of rows, for the signs of the pivots.
/// @param scaled  room for (width + rows)·kStripWidth doubles
/// @param pivots  the entries of the node's rows are filled in
/// @param spread  per row; raised to the largest l²|d| that a negative pivot d adds to the diagonal
/// @return  false where a pivot is 0 or not finite
[[nodiscard]] bool eliminate_indefinite(const Supernode& node, double* panel, dense::Block update,
                                        double* scaled, Team team, Pivots& pivots,
                                        std::vector<double>& spread);

}  // namespace chladni::fem
