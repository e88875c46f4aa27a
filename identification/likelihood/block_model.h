// A modal model in blocks: modes that are nearly repeated share one, so that they can turn into
// each other while they are fitted.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace chladni::identification {

/// left (s² + s damping + stiffness)⁻¹ right; s in units of BlockModel::scale. A general block is
/// one complex mode instead: left (s − A)⁻¹ right with A = [σ ω; −ω σ] and σ + jω its pole, which
/// is l r / (s − pole) and its conjugate with l = left (1, j)ᵀ and r = ½ (1, −j) right.
struct Block {
  Eigen::MatrixXd left;                ///< p×g
  Eigen::MatrixXd right;               ///< g×q
  Eigen::MatrixXd stiffness, damping;  ///< g×g; none of a general block
  bool rigid = false;                  ///< stiffness and damping are zero and stay so
  bool general = false;                ///< g = 2
  std::complex<double> pole = {0, 0};  ///< of a general block

  [[nodiscard]] Eigen::Index size() const { return left.cols(); }
  [[nodiscard]] Eigen::Index mode_count() const { return general ? 1 : size(); }
};

/// Whose delays are fitted: one for all responses, or one for each output or each input.
enum class DelayOf { all, outputs, inputs };

/// Σ blocks + residual, all times e^{−s delay}.
struct BlockModel {
  double scale = 1.0;  ///< [rad/s]
  std::vector<Block> blocks;
  Eigen::MatrixXd residual;       ///< p×q; zero where none is fitted
  double delay = 0.0;             ///< times scale: without unit
  Eigen::VectorXd channel_delay;  ///< likewise, of each output or input on top of it; empty: none
};

/// 2g×2g: ẋ = A x of a block's coordinates and their speeds. Its eigenvalues are the poles, and the
/// upper right corner of (s − A)⁻¹ is (s² + s damping + stiffness)⁻¹. @pre no general block
[[nodiscard]] Eigen::MatrixXd companion(const Block& block);

/// The 2g poles of a block (2 of a general one), those with Im ≥ 0 first.
[[nodiscard]] Eigen::VectorXcd poles(const Block& block);

/// Least damping ratio of a mode that is fitted. Below it the sums over lines, which take
/// differences of poles and their conjugates, have no digits left, and no record tells such a
/// damping from none.
inline constexpr double kLeastDampingRatio = 1e-7;

/// A single mode after a step from `before`, its damping no less than a tenth of what it was nor
/// than kLeastDampingRatio; a block of several modes as it is.
[[nodiscard]] Block damped_after(Block block, const Block& before);

/// Whether that bound holds the damping of a single mode: the data ask for less.
[[nodiscard]] bool is_undamped(const Block& block);

/// Re p < 0 of every pole.
[[nodiscard]] bool is_stable(const Block& block);

/// The same block in the basis in which left and right have the same singular values: takes out the
/// freedom left T, T⁻¹ right. A general block: |l| = |r|, the phase between them stays.
[[nodiscard]] Block balanced(const Block& block);

/// The block as modes of its own, from the quadratic eigenproblem (s² + s D + K) v = 0 with each v
/// turned to the largest real part. Exact where K and D are diagonal in one basis. Empty where a
/// pole is real or the real vectors are nearly dependent.
[[nodiscard]] std::vector<Block> diagonalised(const Block& block);

/// As diagonalised, or where that is empty the eigenvectors of the stiffness and the damping along
/// them: modes whatever it takes.
[[nodiscard]] std::vector<Block> forced_modes(const Block& block);

/// A block of one mode. @param pole  in units of the model's scale
[[nodiscard]] Block single_mode(std::complex<double> pole, const Eigen::VectorXd& left,
                                const Eigen::RowVectorXd& right);

/// The general block of l r / (s − pole) and its conjugate, balanced.
[[nodiscard]] Block general_mode(std::complex<double> pole, const Eigen::VectorXcd& l,
                                 const Eigen::RowVectorXcd& r);

}  // namespace chladni::identification
