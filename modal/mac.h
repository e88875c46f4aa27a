// Similarity of mode shapes. Shapes are columns, real or complex, with n rows for the same places.
#pragma once

#include <Eigen/Core>

namespace chladni::modal {

/// MAC_ij = |a_iᴴ b_j|² / (a_iᴴa_i b_jᴴb_j), m_a×m_b in [0, 1]. It does not depend on scale, sign
/// and phase (Allemang and Brown 1982).
/// @throws InvalidInput  the number of rows differs, or a column is zero or not finite (named)
[[nodiscard]] Eigen::MatrixXd mac(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::MatrixXd mac(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);

/// mac(a, a): large entries off the diagonal show shapes that these places cannot distinguish.
[[nodiscard]] Eigen::MatrixXd auto_mac(const Eigen::MatrixXd& a);
[[nodiscard]] Eigen::MatrixXd auto_mac(const Eigen::MatrixXcd& a);

/// Squared cosines of the principal angles between the spans of a and b, descending, as many as the
/// smaller one has columns; all 1 if one span contains the other. It is the MAC of repeated modes
/// and does not depend on their rotation by the solver (Björck and Golub 1973).
/// @throws InvalidInput  as above, or the columns of one are linearly dependent
[[nodiscard]] Eigen::VectorXd subspace_mac(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::VectorXd subspace_mac(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);

/// Per place (n), over pairs of modes a_i, b_i with equal scale: (Σ|a b|)² / (Σ|a|² Σ|b|²).
/// It is low where the two sets disagree (Lieven and Ewins 1988); 1 where both are zero, 0
/// where only one is.
/// @throws InvalidInput  a and b differ in shape, or an entry is not finite
[[nodiscard]] Eigen::VectorXd comac(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::VectorXd comac(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);

}  // namespace chladni::modal
