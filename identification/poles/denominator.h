// The common denominator of all responses in one step of a vector fit.
#pragma once

#include <Eigen/Core>

#include "identification/poles/pole_products.h"

namespace chladni::identification {

/// cᵀ S c: the part of Σ |w (N − G d)|², d = Σ c φ, that remains with the best numerators N.
struct DenominatorProducts {
  Eigen::MatrixXd left;      ///< S, (2n+1)²: symmetric
  Eigen::MatrixXd rounding;  ///< the same size: cᵀ R c is the possible rounding error of cᵀ S c
};

/// Uses sums of products: S = Σ D − Mᵀ A⁻¹ M. Its relative error is the condition of A, the square
/// of that of the functions. Cost: some ten times pq·n³ operations.
[[nodiscard]] DenominatorProducts denominator_by_sums(const PoleProducts& products);

/// Uses the functions themselves, by Householder reflections of 2K rows per response. The accuracy
/// is given by the condition of the functions; R is 0. Cost: 32 K·n²·pq operations.
/// @param x, poles, rigid  as in PoleProducts
[[nodiscard]] DenominatorProducts denominator_by_rows(const FitData& data, const Eigen::VectorXd& x,
                                                      const Eigen::VectorXcd& poles, bool rigid);

/// Coefficients c (2n+1, the last for the constant) that minimise cᵀ S c under `sums`·c = K
/// (Gustavsen 2006), with the minimum `left`. They are not finite if S determines none.
struct Denominator {
  Eigen::VectorXd coefficient;
  double left = 0.0;
  double rounding = 0.0;  ///< error of `left`

  /// Whether rounding has no effect on the result.
  [[nodiscard]] bool sound() const;
};
[[nodiscard]] Denominator least_denominator(const DenominatorProducts& products,
                                            const Eigen::VectorXd& sums);

}  // namespace chladni::identification
