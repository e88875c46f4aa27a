// Dense matrices of linear systems ẋ = A x + B u, y = C x + D u, by SLICOT.
#pragma once

#include <Eigen/Core>

namespace chladni::dense {

struct ExponentialIntegral {
  Eigen::MatrixXd exponential;  ///< e^{A t}, n×n
  Eigen::MatrixXd integral;     ///< ∫₀ᵗ e^{A s} ds, n×n, in units of t
};

/// By scaling, a Padé approximation of the integral and doubling (SLICOT MB05ND; Benson 1989).
/// Cost: n³ times the logarithm of |A| t.
/// @pre t ≥ 0
/// @throws InvalidInput      A is not square or not finite, or t is negative or not finite
/// @throws NumericalFailure  e^{A t} overflows
[[nodiscard]] ExponentialIntegral exponential_with_integral(const Eigen::MatrixXd& a, double t);

struct BalancedReduction {
  Eigen::MatrixXd a, b, c, d;
  Eigen::VectorXd hankel;     ///< Hankel singular values of the stable part, descending
  Eigen::Index unstable = 0;  ///< states of the rest, which is kept as it is
};

/// Balanced singular perturbation of the part of a continuous system whose eigenvalues have a real
/// part below `boundary`; the rest stays. The static gain of the stable part is kept, and the
/// largest singular value of the error at any frequency is at most twice the sum of the Hankel
/// singular values left out (SLICOT AB09ND; Liu and Anderson 1989). The order is smaller than asked
/// for where the system has fewer states that are both controllable and observable.
/// @param order     states that remain, the rest included
/// @param boundary  [rad/s], 0 or less
/// @throws InvalidInput      sizes differ, or the order is not from `unstable` to n
/// @throws NumericalFailure  the parts cannot be separated
[[nodiscard]] BalancedReduction balanced_reduction(const Eigen::MatrixXd& a,
                                                   const Eigen::MatrixXd& b,
                                                   const Eigen::MatrixXd& c,
                                                   const Eigen::MatrixXd& d, Eigen::Index order,
                                                   double boundary);

}  // namespace chladni::dense
