// Sparse symmetric factorisation: Cholesky for solves, LDLᵀ for counting eigenvalues.
#pragma once

#include <memory>

#include "base/arrays.h"

namespace chladni::fem {

/// What a factorisation will need, known from the pattern alone.
struct FactorForecast {
  double entries = 0.0;  ///< of L
  double flops = 0.0;
  double factor_bytes = 0.0;  ///< L itself
  double work_bytes = 0.0;    ///< the most there is besides L at one time
};

/// A fill-reducing order and the tree of dense blocks that follows from it: what all matrices of
/// one pattern share. Nested dissection (METIS) of the node graph.
class Symbolic {
 public:
  /// @param pattern  n×n, lower triangle; values are not looked at
  explicit Symbolic(const SparseMatrix& pattern);
  /// The pattern of A + s B.
  Symbolic(const SparseMatrix& a, const SparseMatrix& b);
  ~Symbolic();
  Symbolic(Symbolic&&) noexcept;
  Symbolic& operator=(Symbolic&&) noexcept;

  [[nodiscard]] FactorForecast forecast() const;

  struct Tree;
  [[nodiscard]] const Tree& tree() const { return *tree_; }

 private:
  std::unique_ptr<const Tree> tree_;
};

/// A + s B = LLᵀ of a symmetric positive definite matrix, kept for repeated solves.
class Factorization {
 public:
  /// @throws NumericalFailure  the matrix is not positive definite
  explicit Factorization(const SparseMatrix& matrix);
  Factorization(const Symbolic& symbolic, const SparseMatrix& a, double s, const SparseMatrix& b);
  ~Factorization();
  Factorization(Factorization&&) noexcept;
  Factorization& operator=(Factorization&&) noexcept;

  /// x with (A + s B) x = b, for each of the columns of b. Cost: twice the factor's entries per
  /// column; columns together are cheaper than one by one.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const;

  struct Numeric;

 private:
  std::unique_ptr<Numeric> numeric_;
};

/// How the eigenvalues of A + s B lie about zero, by Sylvester's law from the signs of the pivots
/// of LDLᵀ; the factor is not kept.
///
/// Without exchanges of rows the signs are those of a matrix A + s B + E with |e_ij| of the order
/// of 1e-16 (g_i g_j)^½, where g_i = Σ_k l_ik² |d_k| is a_ii where no pivot is negative and grows
/// without bounds where a small pivot stands before large entries (Higham 2002, Accuracy and
/// Stability of Numerical Algorithms, section 11.1). The two figures below say how far that went.
struct Inertia {
  Eigen::Index negative = 0, positive = 0;
  double smallest_pivot = 0.0;  ///< |d| relative to the largest entry of its row in A, s B, beside,
                                ///< below and before it; 0: the elimination stopped there
  double growth = 0.0;          ///< the largest g_i relative to the largest entry of row i

  /// Whether the signs can be those of A + s B itself: no pivot is rounding, and the rounding is
  /// less than 1e-10 of the entries. Bodies reach 3e-11 (a plate 3000 times as long as thick) and
  /// 5e3.
  [[nodiscard]] bool trusted() const {
    return smallest_pivot > kLeastPivot && growth < kMostGrowth;
  }
  static constexpr double kLeastPivot = 1e-12;
  static constexpr double kMostGrowth = 1e6;
};
/// Cost: that of a factorisation. @throws Interrupted
[[nodiscard]] Inertia inertia(const Symbolic& symbolic, const SparseMatrix& a, double s,
                              const SparseMatrix& b);

}  // namespace chladni::fem
