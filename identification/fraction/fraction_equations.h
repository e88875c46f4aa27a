// The linear problem of each iteration of a matrix fraction.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/fit_data.h"
#include "identification/matrix_fraction.h"

namespace chladni::identification {

/// Polynomials φ_0 … φ_d, orthonormal in Re Σ weight² φ̄ φ on s = jx. @param
/// weight  K, not negative
[[nodiscard]] PolynomialBasis orthonormal_basis(const Eigen::VectorXd& x,
                                                const Eigen::VectorXd& weight, Eigen::Index degree);

/// Errors E_k = W_k ∘ [F_k (Σ_a φ_a D_a X_k − Σ_a ψ_a N_a)], linear in D_a and N_a. With F = D⁻¹ of
/// the last iteration and X = G they are the errors of Sanathanan and Koerner. With F = D⁻¹ and
/// X = D⁻¹N they are the derivatives of the output error.
class FractionEquations {
 public:
  /// All arguments must live longer than this object.
  /// @param divided  [K] F_k, p×p; @param values  K×pq: X
  /// @param d_basis, n_basis  K×(d+1) and K×(n+1): φ and ψ
  FractionEquations(const FitData& data, const std::vector<Eigen::MatrixXcd>& divided,
                    const Eigen::MatrixXcd& values, const Eigen::MatrixXcd& d_basis,
                    const Eigen::MatrixXcd& n_basis);

  /// Number of coefficients. Order: D by ((a p + column) p + row), then each column
  /// of N by (a p + row).
  [[nodiscard]] Eigen::Index count() const { return d_count_ + inputs_ * n_count_; }

  /// The errors for these coefficients, K×pq. If `leading`, φ_d I is added to D.
  [[nodiscard]] Eigen::MatrixXcd errors(const Eigen::VectorXd& coefficients, bool leading) const;

  /// Re Σ (dE)ᴴ e for errors e, K×pq.
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::MatrixXcd& errors) const;

  /// −(Re Σ dEᴴ dE)⁻¹ gradient, with the diagonal of the matrix multiplied by 1 + damping.
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& gradient, double damping) const;

  [[nodiscard]] Eigen::MatrixXd denominator(const Eigen::VectorXd& coefficients,
                                            Eigen::Index a) const;
  [[nodiscard]] Eigen::MatrixXd numerator(const Eigen::VectorXd& coefficients,
                                          Eigen::Index a) const;

 private:
  [[nodiscard]] Eigen::MatrixXcd weighted(Eigen::Index line, Eigen::Index input) const;
  [[nodiscard]] Eigen::MatrixXd gram(Eigen::Index input) const;

  const FitData& data_;
  const std::vector<Eigen::MatrixXcd>& divided_;
  const Eigen::MatrixXcd& values_;
  const Eigen::MatrixXcd& d_basis_;
  const Eigen::MatrixXcd& n_basis_;
  Eigen::Index outputs_, inputs_, d_count_, n_count_;
  std::vector<Eigen::MatrixXd> gram_;  // per input: D and one column of N
};

}  // namespace chladni::identification
