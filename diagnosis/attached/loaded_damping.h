// Damping ratios that are those of the modes as they are measured, with all that hangs on the body.
#pragma once

#include <vector>

#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// D where the ratios that the structure states are those of the modes of the body as the causes
/// leave it, and not of the body without them:
///
///     F diag(1 + ρ_k) Fᵀ,  F = M₁ Φ₁ diag(2 ζ_k ω_k)^½,   K₁ Φ₁ = M₁ Φ₁ diag(ω_k²)
///
/// with all springs and masses of the causes in K₁ and M₁, mode k of which has the ratio of the
/// structure's k-th, a rigid-body mode that is one no longer the mean one. ρ is by how much,
/// relative, the loss of each mode deviates: State::relative_damping. Carried masses have damping
/// of their own and are left out; what near modes share of damping stays as it is.
///
/// Source: a damping ratio is measured on the structure that is there; that one matrix D serves all
/// hypotheses is the other reading of the same number.
struct LoadedDamping {
  Eigen::MatrixXd factor;  ///< F, r×r [s^-½]; 0×0 where the causes leave K and M as they are
  Eigen::VectorXd bare;    ///< r [s^-½]: roots of the losses of the structure's own modes

  /// What D gains [1/s], r×r, over that of the structure's own modes, which deviate by the same ρ;
  /// 0×0 where nothing is another.
  /// @param relative  ρ, r, or empty for 0
  [[nodiscard]] Eigen::MatrixXd gained(const Eigen::VectorXd& relative) const;
};

/// Cost: 20 r³.
/// @throws NumericalFailure  M₁ is not positive definite
[[nodiscard]] LoadedDamping loaded_damping(const Structure& structure,
                                           const std::vector<Supposed>& causes);

}  // namespace chladni::diagnosis
