// Damping for ratios that were measured with all causes attached to the body.
#pragma once

#include <vector>

#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// The matrix D for the case that the stated damping ratios belong to the modes of the body with
/// the causes, and not to the modes of the body without them:
///
///     F diag(1 + ρ_k) Fᵀ,  F = M₁ Φ₁ diag(ω_k)^½ T diag(2 ζ_k)^½,   K₁ Φ₁ = M₁ Φ₁ diag(ω_k²)
///
/// K₁ and M₁ contain all springs and masses of the causes. Loaded mode k has the damping ratio of
/// the structure's mode k: T is 1, but for modes that are nearer to each other than about
/// Constants::pair_width. Of these T is the rotation to the structure's modes of their numbers,
/// so that D is continuous where modes are repeated. A rigid-body mode that now has a frequency
/// gets the mean ratio. ρ_k is the relative deviation of the loss of mode k:
/// State::relative_damping. Carried masses have damping of their own and are left out. Damping that
/// neighbouring modes share does not change.
///
/// Source: a damping ratio is measured on the structure as it is. The other reading of the same
/// number is that one matrix D serves all hypotheses.
struct LoadedDamping {
  Eigen::MatrixXd factor;  ///< F, r×r [s^-½]; 0×0 if the causes change neither K nor M
  Eigen::VectorXd bare;    ///< r [s^-½]: square roots of the losses of the structure's own modes

  /// The increase of D [1/s], r×r, over the D of the structure's own modes with the same ρ; 0×0 if
  /// nothing changes.
  /// @param relative  ρ, r, or empty for 0
  [[nodiscard]] Eigen::MatrixXd gained(const Eigen::VectorXd& relative) const;
};

/// Cost: 20 r³.
/// @throws NumericalFailure  M₁ is not positive definite
[[nodiscard]] LoadedDamping loaded_damping(const Structure& structure,
                                           const std::vector<Supposed>& causes);

}  // namespace chladni::diagnosis
