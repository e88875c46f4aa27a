// The denominator that all responses share, in one step of a vector fit.
#pragma once

#include <Eigen/Core>

#include "identification/poles/pole_products.h"

namespace chladni::identification {

/// cᵀ S c: what the responses' numerators leave of Σ |w (N − G d)|², d = Σ c φ.
struct DenominatorProducts {
  Eigen::MatrixXd left;      ///< S, (2n+1)²: symmetric
  Eigen::MatrixXd rounding;  ///< likewise: cᵀ R c is what rounding may have done to cᵀ S c
};

/// From sums of products: S = Σ D − Mᵀ A⁻¹ M. Its relative error is the condition of A, the square
/// of that of the functions. Cost: pq·n³ operations times some ten.
[[nodiscard]] DenominatorProducts denominator_by_sums(const PoleProducts& products);

/// From the functions themselves, by Householder's reflections of K rows per response: exact to the
/// condition of the functions. R is 0. Cost: 32 K·n²·pq operations.
/// @param x, poles, rigid  as in PoleProducts
[[nodiscard]] DenominatorProducts denominator_by_rows(const FitData& data, const Eigen::VectorXd& x,
                                                      const Eigen::VectorXcd& poles, bool rigid);

/// Coefficients c (2n+1, the last that of the constant) of the least cᵀ S c with `sums`·c = K
/// (Gustavsen 2006), and what it is; not finite where S determines none.
struct Denominator {
  Eigen::VectorXd coefficient;
  double left = 0.0;
  double rounding = 0.0;  ///< of `left`

  /// Rounding decides nothing of it.
  [[nodiscard]] bool sound() const;
};
[[nodiscard]] Denominator least_denominator(const DenominatorProducts& products,
                                            const Eigen::VectorXd& sums);

}  // namespace chladni::identification
