// Sparse symmetric factorisation: Cholesky for solves, LDLᵀ for counting eigenvalues.
#pragma once

#include <memory>

#include "base/arrays.h"

namespace chladni::fem {

/// Operations and memory that a factorisation will need, from the pattern alone.
struct FactorForecast {
  double entries = 0.0;  ///< stored entries of L on and below the diagonal
  double flops = 0.0;
  double factor_bytes = 0.0;  ///< L itself, with the corners above the diagonal that CHOLMOD stores
  double work_bytes = 0.0;    ///< largest memory besides L at one time, while L is made
  double count_bytes = 0.0;   ///< largest memory of a count (`inertia`), which keeps no L
  double analysis_bytes = 0.0;  ///< of the order and the tree themselves
};

/// A fill-reducing order and the tree of supernodes that follows from the order. All matrices of
/// one pattern share them. The order is a nested dissection (METIS) of the node graph.
class Symbolic {
 public:
  /// @param pattern  n×n, lower triangle; the values do not matter
  explicit Symbolic(const SparseMatrix& pattern);
  /// The pattern of A + s B.
  Symbolic(const SparseMatrix& a, const SparseMatrix& b);
  ~Symbolic();
  Symbolic(Symbolic&&) noexcept;
  Symbolic& operator=(Symbolic&&) noexcept;

  [[nodiscard]] FactorForecast forecast() const;
  /// Number of threads that it was made for.
  [[nodiscard]] int threads() const;

  struct Tree;
  [[nodiscard]] const Tree& tree() const { return *tree_; }

 private:
  std::unique_ptr<const Tree> tree_;
};

/// The Cholesky factor of A + s B = LLᵀ, symmetric positive definite, kept for repeated solves.
class Factorization {
 public:
  /// @throws NumericalFailure  the matrix is not positive definite
  explicit Factorization(const SparseMatrix& matrix);
  /// The analysis must outlive the factor here; a shared one is kept.
  Factorization(const Symbolic& symbolic, const SparseMatrix& a, double s, const SparseMatrix& b);
  Factorization(std::shared_ptr<const Symbolic> symbolic, const SparseMatrix& a, double s,
                const SparseMatrix& b);
  ~Factorization();
  Factorization(Factorization&&) noexcept;
  Factorization& operator=(Factorization&&) noexcept;

  /// Solves (A + s B) x = b for each column of b. Cost: twice the factor's entries per column;
  /// several columns together are cheaper than one by one.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const;

  struct Numeric;

 private:
  std::unique_ptr<Numeric> numeric_;
};

/// The inertia of A + s B: the numbers of negative and positive eigenvalues. Sylvester's law gives
/// them from the signs of the pivots of LDLᵀ. The factor is not kept.
///
/// Rows are not exchanged. The signs are then those of a matrix A + s B + E with |e_ij| of the
/// order of 1e-16 (g_i g_j)^½, where g_i = Σ_k l_ik² |d_k|. Where no pivot is negative, g_i is
/// a_ii. Where a small pivot stands before large entries, g_i grows without bounds (Higham 2002,
/// Accuracy and Stability of Numerical Algorithms, section 11.1). The two figures below measure
/// this growth.
struct Inertia {
  Eigen::Index negative = 0, positive = 0;
  double smallest_pivot = 0.0;  ///< |d| relative to the largest of: its row in A and s B, its
                                ///< column during the elimination, the terms l²|d| of negative
                                ///< pivots in its row; 0: the elimination stopped
  double growth = 0.0;          ///< the largest term l_ik² |d_k| of a negative pivot relative to
                                ///< the largest entry of row i of A and s B; 1 or more

  /// Whether the signs are those of A + s B itself: no pivot is only rounding, and the rounding is
  /// less than 1e-10 of the entries. Tested bodies reached 3e-11 for smallest_pivot (a plate 3000
  /// times as long as thick) and 5e3 for growth.
  [[nodiscard]] bool trusted() const {
    return smallest_pivot > kLeastPivot && growth < kMostGrowth;
  }
  static constexpr double kLeastPivot = 1e-12;
  static constexpr double kMostGrowth = 1e6;
};
/// The inertia of A + s B. Cost: one factorisation. @throws Interrupted
[[nodiscard]] Inertia inertia(const Symbolic& symbolic, const SparseMatrix& a, double s,
                              const SparseMatrix& b);

}  // namespace chladni::fem
