// Residuals of modes, and refinement of the modes to their last digits.
#pragma once

#include "fem/factor/factorization.h"
#include "fem/system.h"

namespace chladni::fem {

/// Relative residual of each pair (λ, φ), φᵀMφ = 1, in the inverted problem on which Lanczos works:
///
///     ‖φ − (λ + s)(K + sM)⁻¹Mφ‖_M (λ + s)/λ = ‖(K + sM)⁻¹(Kφ − λMφ)‖_M (λ + s)/λ.
///
/// An eigenvalue lies within this fraction of λ (Krylov-Bogoliubov bound of the inverted problem);
/// for the frequency it is half of this fraction. A shape with an error ε has a residual of about ε
/// or more. The plain ‖Kφ − λMφ‖/(λ‖Mφ‖) is too sensitive: it multiplies the rounding of φ by the
/// highest eigenvalue of the mesh and never falls below 10⁻⁴ on a wire flexure. The normwise
/// backward error ‖r‖/((‖K‖ + λ‖M‖)‖φ‖) (Higham and Higham 1998, SIAM J. Matrix Anal. Appl. 20,
/// 493-512) is not sensitive enough: it accepts a mode that is mixed with its neighbour.
///
/// @param factor  of K + sM
/// @param known   n×r: mass-orthonormal modes to which the shapes are orthogonal, for example the
///                rigid ones; the residual's part along them is rounding and does not count
/// @param lambda  m; shapes n×m
/// @return  m, none negative; infinite or NaN where λ is 0
/// Cost: one solve per mode.
/// Source: Ericsson and Ruhe (1980), Math. Comp. 35, 1251-1268; Grimes, Lewis and Simon (1994),
/// SIAM J. Matrix Anal. Appl. 15, 228-272.
[[nodiscard]] Eigen::VectorXd residuals(const System& system, const Factorization& factor, double s,
                                        const Eigen::MatrixXd& known, const Eigen::VectorXd& lambda,
                                        const Eigen::MatrixXd& shapes);

/// KΦ, n×m, in extended precision. The suspended motions (system.suspended) are given the force of
/// their springs instead of their product with K. Cost: about ten products with K.
[[nodiscard]] Eigen::MatrixXd stiffness_times(const System& system, const Eigen::MatrixXd& shapes);

/// Rayleigh-Ritz in the span of Φ: each value is accurate to its own last digits.
/// @param lambda   m, after it: ascending
/// @param shapes   n×m, independent; after it M-orthonormal
/// @param product  n×m, KΦ before and after
/// @return  m×m, T of Φ T: the shapes after it by those before
Eigen::MatrixXd ritz(const System& system, Eigen::VectorXd& lambda, Eigen::MatrixXd& shapes,
                     Eigen::MatrixXd& product);

/// One step of iterative refinement: Φ − (K + sM)⁻¹(KΦ − MΦΛ), then Rayleigh-Ritz in its span, with
/// KΦ in extended precision. On slender bodies K's highest eigenvalue is 10¹² times the lowest, and
/// double precision leaves relative errors of 10⁻⁶ to 10⁻⁸.
///
/// The suspended motions (system.suspended) are removed from Φ and KΦ gets the force of their
/// springs instead. The reason: rounding of K's entries resists a rigid motion like a spring of
/// 10⁻¹⁶ of the body's stiffness.
///
/// @param lambda  m, ascending before and after; shapes n×m, M-orthonormal before and after
/// @return  the residuals after the step, as in `residuals`
/// Cost: two solves and about ten products with K per mode.
[[nodiscard]] Eigen::VectorXd polished(const System& system, const Factorization& factor, double s,
                                       const Eigen::MatrixXd& known, Eigen::VectorXd& lambda,
                                       Eigen::MatrixXd& shapes);

/// ‖Kφ‖ / (max_i K_ii ‖φ‖) of shapes that cost no energy: their normwise backward error.
[[nodiscard]] Eigen::VectorXd rigid_residuals(const System& system, const Eigen::MatrixXd& shapes);

}  // namespace chladni::fem
