// A block of modes as partial fractions, and a response's derivatives in them.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "identification/likelihood/block_model.h"

namespace chladni::identification {

/// (s² + sD + K)⁻¹ = Σ_r x_r y_r / (s − p_r), r = 1 … 2g; of a general block (s − A)⁻¹, r = 1, 2.
struct BlockFractions {
  Eigen::VectorXcd pole;       ///< 2g or 2; none of a rigid block
  Eigen::MatrixXcd x, y;       ///< g×2g, 2g×g
  Eigen::MatrixXcd left;       ///< p×2g: left x
  Eigen::MatrixXcd right;      ///< 2g×q: y right
  Eigen::Index first = 0;      ///< row of its first function: the fractions, then their squares
  Eigen::Index parameter = 0;  ///< its first
};

/// Of a block that is not rigid. Poles of it that are one are moved apart by 1e-9 of their size.
[[nodiscard]] BlockFractions fractions(const Block& block);

/// The block as general modes, a partial fraction each: what it does is the same. Empty where a
/// pole is real.
[[nodiscard]] std::vector<Block> general_modes(const Block& block);

/// At most 12 functions and 24 parameters of a response in a block: 3 modes, 12 rigid-body modes.
using SmallComplex =
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 12, 24>;

/// Derivatives of the response (i, j) by the parameters it has in a block: left(i, ·), right(·, j),
/// then stiffness and damping, or σ and ω of a general block. In the block's functions, 1/(s −
/// p_r), then 1/(s − p_r)²; of a rigid block in 1/s².
[[nodiscard]] SmallComplex derivatives(const Block& block, const BlockFractions& parts,
                                       Eigen::Index i, Eigen::Index j);

}  // namespace chladni::identification
