// Matrix equations of linear systems under white noise, by SLICOT; and by doubling, to compare
// many.
#pragma once

#include <Eigen/Core>

namespace chladni::dense {

/// x⁺ = A x + w, y = C x + v with white noise of mean 0 and the covariances E[w wᵀ] = Q,
/// E[v vᵀ] = R, E[w vᵀ] = S.
struct NoisySystem {
  Eigen::MatrixXd a;  ///< n×n
  Eigen::MatrixXd c;  ///< p×n
  Eigen::MatrixXd q;  ///< n×n
  Eigen::MatrixXd r;  ///< p×p, positive definite
  Eigen::MatrixXd s;  ///< n×p
};

/// The covariance P of x given all earlier y, in steady state: the stabilising solution of
///     P = A P Aᵀ + Q − (A P Cᵀ + S) (C P Cᵀ + R)⁻¹ (A P Cᵀ + S)ᵀ
/// by the generalised Schur vectors of the pencil (SLICOT SB02OD; Van Dooren 1981). It is solved
/// twice, the second time with states of variance 1. Cost: about 400 (2n + p)³.
/// @throws InvalidInput      sizes differ, an entry is not finite, or R is not positive definite
/// @throws NumericalFailure  there is no stabilising solution: a state that neither decays nor is
///                           seen, or that neither decays nor is disturbed
[[nodiscard]] Eigen::MatrixXd prediction_covariance(const NoisySystem& system);

/// P = A P Aᵀ + Q: the covariance of x⁺ = A x + w in steady state (SLICOT SB03MD; Kitagawa 1977).
/// Cost: about 35 n³.
/// @param q  n×n, symmetric
/// @throws InvalidInput      sizes differ, or an entry is not finite
/// @throws NumericalFailure  A has an eigenvalue on the unit circle or outside of it
[[nodiscard]] Eigen::MatrixXd stationary_covariance(const Eigen::MatrixXd& a,
                                                    const Eigen::MatrixXd& q);

/// X = Aᵀ X (I + G X)⁻¹ A + H by doubling (Chu, Fan, Lin and Wang 2004): after k steps that of 2ᵏ
/// steps of the difference equation. It is for the comparison of many systems whose final one goes
/// to prediction_covariance: faster, but it asks for states of one scale. The covariance P of
/// above, with S = 0, is X with Aᵀ for A, G = Cᵀ R⁻¹ C and H = Q. Cost: 17 n³ per step, log₂ of the
/// slowest time constant in samples, and 5.
/// @param g, h  n×n, symmetric, positive semidefinite
/// @throws NumericalFailure  there is no limit, or it is not a finite one
[[nodiscard]] Eigen::MatrixXd doubled_riccati(Eigen::MatrixXd a, Eigen::MatrixXd g,
                                              Eigen::MatrixXd h);

}  // namespace chladni::dense
