// A block of modes as partial fractions, and the derivatives of a response with them.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "identification/likelihood/block_model.h"

namespace chladni::identification {

/// (s² + sD + K)⁻¹ = Σ_r x_r y_r / (s − p_r), r = 1 … 2g; (s − A)⁻¹ for a general block, r = 1, 2.
struct BlockFractions {
  Eigen::VectorXcd pole;       ///< 2g or 2; empty for a rigid block
  Eigen::MatrixXcd x, y;       ///< g×2g, 2g×g
  Eigen::MatrixXcd left;       ///< p×2g: left x
  Eigen::MatrixXcd right;      ///< 2g×q: y right
  Eigen::Index first = 0;      ///< row of its first function: the fractions, then their squares
  Eigen::Index parameter = 0;  ///< the block's first parameter
};

/// Fractions of a block that is not rigid. Equal poles are moved apart by 1e-9 of their size.
[[nodiscard]] BlockFractions fractions(const Block& block);

/// The block as general modes, one for each pair of partial fractions; its response is the same.
/// Empty if a pole is real.
[[nodiscard]] std::vector<Block> general_modes(const Block& block);

/// At most 12 functions and 24 parameters of one response in a block: 3 modes, 12 rigid-body modes.
using SmallComplex =
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 12, 24>;

/// Derivatives of the response (i, j) by its parameters in a block: left(i, ·), right(·, j), then
/// stiffness and damping, or σ and ω of a general block. The rows belong to the block's functions,
/// 1/(s − p_r), then 1/(s − p_r)²; for a rigid block 1/s².
[[nodiscard]] SmallComplex derivatives(const Block& block, const BlockFractions& parts,
                                       Eigen::Index i, Eigen::Index j);

}  // namespace chladni::identification
