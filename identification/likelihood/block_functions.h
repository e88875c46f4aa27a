// The functions on every line from which the derivatives of a block's responses are built.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/likelihood/block_model.h"

namespace chladni::identification {

/// A response (i, j) of a block is l_i H r_j. Its derivatives by the block's own parameters (in
/// the order of NormalEquations) are l_i dH/dθ r_j. H and dH/dθ are g×g functions of s with
/// real coefficients.
struct BlockFunctions {
  Eigen::Index size = 0;   ///< g
  Eigen::Index kinds = 1;  ///< number of matrices: H, then dH/dθ of each θ
  Eigen::Index first = 0;  ///< column of the block's first function
  Eigen::Index mode = 0;   ///< column of the block's first left shape among those of all blocks
  Eigen::Index left = 0, right = 0, own = 0;  ///< first parameter of each kind

  [[nodiscard]] Eigen::Index column(Eigen::Index kind, Eigen::Index a, Eigen::Index b) const {
    return first + size * (size * kind + b) + a;
  }
};

/// Positions of the functions and parameters of each block, for p outputs and q inputs.
[[nodiscard]] std::vector<BlockFunctions> functions_of(const BlockModel& model,
                                                       Eigen::Index outputs, Eigen::Index inputs);

/// U: number of functions of all blocks.
[[nodiscard]] Eigen::Index function_count(const std::vector<BlockFunctions>& all);

/// All functions of a block on all lines, real above imaginary parts: 2K×(g² kinds), in the
/// order of `column`. The code never divides by a difference of poles. The functions span 4g
/// dimensions at most.
/// @param x  K: ω over the model's scale
[[nodiscard]] Eigen::MatrixXd function_values(const Block& block, const Eigen::VectorXd& x);

}  // namespace chladni::identification
