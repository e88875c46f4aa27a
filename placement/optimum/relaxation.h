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
  double bound = 0.0;    ///< upper bound of the maximum, by concavity: value + Σ largest d_c − zᵀd
};

/// Newton's method with a barrier on a working set. The set grows by candidates whose gain is too
/// large to leave out. The bound holds for every z, so it is valid wherever the iteration stops.
/// Cost: N r² per round, a³ per step on the working set of a (some tens).
/// @param rows    N×r, the free candidates
/// @param base    r×r, positive definite
/// @param give_up value of the best known choice: the search stops once the bound is below it
[[nodiscard]] Relaxation relaxed(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& base,
                                 Eigen::Index count, double give_up, double tolerance);

}  // namespace chladni::placement
