// How well modes solve their equation, and their last digits.
#pragma once

#include "fem/factor/factorization.h"
#include "fem/system.h"

namespace chladni::fem {

/// Relative residual of each pair (λ, φ), φᵀMφ = 1, of the inverted problem on which Lanczos works:
///
///     ‖φ − (λ + s)(K + sM)⁻¹Mφ‖_M (λ + s)/λ = ‖(K + sM)⁻¹(Kφ − λMφ)‖_M (λ + s)/λ.
///
/// An eigenvalue lies within this fraction of λ (Krylov-Bogoliubov bound of the inverted problem),
/// half of it for the frequency, and a shape that is wrong by ε shows it as about ε or more. The
/// plain ‖Kφ − λMφ‖/(λ‖Mφ‖) does not serve: rounding of φ, multiplied by the highest eigenvalue of
/// the mesh, leaves 10⁻⁴ of it on a wire flexure whatever is done. The normwise backward error
/// ‖r‖/((‖K‖ + λ‖M‖)‖φ‖) (Higham and Higham 1998, SIAM J. Matrix Anal. Appl. 20, 493-512) is as
/// blind as that is nervous: a mode mixed with its neighbour passes.
///
/// @param factor  of K + sM
/// @param known   n×r: mass-orthonormal modes that the shapes are orthogonal to, the rigid ones
///                first of all; what rounding brings along them does not count
/// @param lambda  m; shapes n×m
/// @return  m, none negative; infinite or NaN where λ is 0
/// Cost: one solve per mode.
/// Source: Ericsson and Ruhe (1980), Math. Comp. 35, 1251-1268; Grimes, Lewis and Simon (1994),
/// SIAM J. Matrix Anal. Appl. 15, 228-272.
[[nodiscard]] Eigen::VectorXd residuals(const System& system, const Factorization& factor, double s,
                                        const Eigen::MatrixXd& known, const Eigen::VectorXd& lambda,
                                        const Eigen::MatrixXd& shapes);

/// One step of iterative refinement: Φ − (K + sM)⁻¹(KΦ − MΦΛ), then Rayleigh-Ritz in its span, with
/// KΦ in extended precision. On slender bodies K's highest eigenvalue is 10¹² times the lowest, and
/// double precision leaves 10⁻⁶ to 10⁻⁸ of what is sought.
///
/// What a suspended body does as a whole is taken out of Φ and put back as the force of its
/// springs: rounded entries of K hold a rigid motion as a spring of 10⁻¹⁶ of the body's stiffness
/// would.
///
/// @param lambda  m, ascending before and after; shapes n×m, M-orthonormal before and after
/// @return  the residuals after it, as above
/// Cost: two solves and about ten products with K per mode.
[[nodiscard]] Eigen::VectorXd polished(const System& system, const Factorization& factor, double s,
                                       const Eigen::MatrixXd& known, Eigen::VectorXd& lambda,
                                       Eigen::MatrixXd& shapes);

/// ‖Kφ‖ / (max K ‖φ‖) of shapes that cost no energy: their normwise backward error.
[[nodiscard]] Eigen::VectorXd rigid_residuals(const System& system, const Eigen::MatrixXd& shapes);

}  // namespace chladni::fem
