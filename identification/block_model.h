// A modal model in blocks: modes that are nearly repeated share one, so that they can turn into
// each other while they are fitted.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace chladni::identification {

/// left (s² + s damping + stiffness)⁻¹ right; s in units of BlockModel::scale.
struct Block {
  Eigen::MatrixXd left;                ///< p×g
  Eigen::MatrixXd right;               ///< g×q
  Eigen::MatrixXd stiffness, damping;  ///< g×g
  bool rigid = false;                  ///< stiffness and damping are zero and stay so

  [[nodiscard]] Eigen::Index size() const { return left.cols(); }
};

/// Σ blocks + residual, all times e^{−s delay}.
struct BlockModel {
  double scale = 1.0;  ///< [rad/s]
  std::vector<Block> blocks;
  Eigen::MatrixXd residual;  ///< p×q; zero where none is fitted
  double delay = 0.0;        ///< times scale: without unit
};

/// 2g×2g: ẋ = A x of a block's coordinates and their speeds. Its eigenvalues are the poles, and the
/// upper right corner of (s − A)⁻¹ is (s² + s damping + stiffness)⁻¹.
[[nodiscard]] Eigen::MatrixXd companion(const Block& block);

/// The 2g poles of a block, those with Im ≥ 0 first.
[[nodiscard]] Eigen::VectorXcd poles(const Block& block);

/// Re p < 0 of every pole.
[[nodiscard]] bool is_stable(const Block& block);

/// The same block in the basis in which left and right have the same singular values: takes out the
/// freedom left T, T⁻¹ right.
[[nodiscard]] Block balanced(const Block& block);

/// The block as modes of its own, from the quadratic eigenproblem (s² + s D + K) v = 0 with each v
/// turned to the largest real part. Exact where K and D are diagonal in one basis. Empty where a
/// pole is real or the real vectors are nearly dependent.
[[nodiscard]] std::vector<Block> diagonalised(const Block& block);

/// A block of one mode. @param pole  in units of the model's scale
[[nodiscard]] Block single_mode(std::complex<double> pole, const Eigen::VectorXd& left,
                                const Eigen::RowVectorXd& right);

}  // namespace chladni::identification
