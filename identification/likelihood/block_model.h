// A modal model in blocks. Nearly repeated modes share a block, so that the fit can mix them.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace chladni::identification {

/// left (s² + s damping + stiffness)⁻¹ right; s in units of BlockModel::scale. A general block is
/// one complex mode instead: left (s − A)⁻¹ right with A = [σ ω; −ω σ] and pole σ + jω. This block
/// equals l r / (s − pole) plus the conjugate, with l = left (1, j)ᵀ and r = ½ (1, −j) right.
struct Block {
  Eigen::MatrixXd left;                ///< p×g
  Eigen::MatrixXd right;               ///< g×q
  Eigen::MatrixXd stiffness, damping;  ///< g×g; empty for a general block
  bool rigid = false;                  ///< stiffness and damping are zero and stay zero
  bool general = false;                ///< g = 2
  std::complex<double> pole = {0, 0};  ///< of a general block

  [[nodiscard]] Eigen::Index size() const { return left.cols(); }
  [[nodiscard]] Eigen::Index mode_count() const { return general ? 1 : size(); }
};

/// The delays that are fitted: one for all responses, or one for each output or each input.
enum class DelayOf { all, outputs, inputs };

/// Σ blocks + residual, all times e^{−s delay}.
struct BlockModel {
  double scale = 1.0;  ///< [rad/s]
  std::vector<Block> blocks;
  Eigen::MatrixXd residual;       ///< p×q; zero where none is fitted
  double delay = 0.0;             ///< times scale: dimensionless
  Eigen::VectorXd channel_delay;  ///< added to `delay`, of each output or input; empty: none
};

/// 2g×2g matrix A: ẋ = A x for a block's coordinates and their velocities. Its eigenvalues
/// are the poles. The upper right corner of (s − A)⁻¹ is (s² + s damping + stiffness)⁻¹.
/// @pre no general block
[[nodiscard]] Eigen::MatrixXd companion(const Block& block);

/// The 2g poles of a block (2 of a general one), those with Im ≥ 0 first.
[[nodiscard]] Eigen::VectorXcd poles(const Block& block);

/// Least damping ratio of a fitted mode. Below it the sums over lines lose all digits, because
/// they take differences between poles and their conjugates. No record distinguishes such a
/// damping from zero.
inline constexpr double kLeastDampingRatio = 1e-7;

/// Limits the damping of a single mode after a step from `before`: at least a tenth of the old
/// value and at least kLeastDampingRatio, and of a complex mode less than critical
/// (Constants::least_turning). A block of several modes is not changed.
[[nodiscard]] Block damped_after(Block block, const Block& before);

/// Whether that bound holds the damping of a single mode, because the data ask for less.
[[nodiscard]] bool is_undamped(const Block& block);

/// Whether Re p < 0 for every pole.
[[nodiscard]] bool is_stable(const Block& block);

/// The same block in the basis where left and right have the same singular values. This removes the
/// freedom left T, T⁻¹ right. A general block gets |l| = |r|; the phase between them stays.
[[nodiscard]] Block balanced(const Block& block);

/// The modes of the block, from the quadratic eigenproblem (s² + s D + K) v = 0; each v is turned
/// to the largest real part. Exact if one basis makes K and D diagonal. Empty if a pole is real or
/// the real vectors are nearly dependent.
[[nodiscard]] std::vector<Block> diagonalised(const Block& block);

/// As diagonalised(). If that is empty, it uses the eigenvectors of the stiffness and the damping
/// along them: it always returns modes.
[[nodiscard]] std::vector<Block> forced_modes(const Block& block);

/// A block of one mode. @param pole  in units of the model's scale
[[nodiscard]] Block single_mode(std::complex<double> pole, const Eigen::VectorXd& left,
                                const Eigen::RowVectorXd& right);

/// The general block of l r / (s − pole) and its conjugate, balanced.
[[nodiscard]] Block general_mode(std::complex<double> pole, const Eigen::VectorXcd& l,
                                 const Eigen::RowVectorXcd& r);

}  // namespace chladni::identification
