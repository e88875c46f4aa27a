// The concave relaxation of the D-optimal choice.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::placement {

/// max log det(base + Σ z_c φ_c φ_cᵀ) over 0 <= z <= 1, Σ z = count, for the free candidates.
struct Relaxation {
  Eigen::VectorXd z;     ///< per free candidate
  Eigen::VectorXd gain;  ///< d_c = φ_cᵀ M(z)⁻¹ φ_c
  double value = 0.0;    ///< at z
  double bound = 0.0;    ///< of the maximum, by concavity: value + Σ largest d_c − zᵀd
};

/// Barrier Newton on a working set of candidates that grows by those whose gain is too large to be
/// left out. The bound holds for every z, so that it is true wherever the iteration stops. Cost:
/// N r² per round, a³ per step on the working set of a (some tens).
/// @param rows    N×r, the free candidates
/// @param base    r×r, positive definite
/// @param give_up the value of the best choice known: no more is asked once the bound is below it
[[nodiscard]] Relaxation relaxed(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& base,
                                 Eigen::Index count, double give_up, double tolerance);

}  // namespace chladni::placement
