// Damping ratios that are those of the modes as they are measured, with all that hangs on the body.
#pragma once

#include <vector>

#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// What D gains [1/s], r×r, where the ratios that the structure states are those of the modes of
/// the body as the causes leave it, and not of the body without them:
///
///     M₁ Φ₁ diag(2 ζ_k ω_k) Φ₁ᵀ M₁ − D,   K₁ Φ₁ = M₁ Φ₁ diag(ω_k²)
///
/// with all springs and masses of the causes in K₁ and M₁, mode k of which has the ratio of the
/// structure's k-th, a rigid-body mode that is one no longer the mean one. Carried masses have
/// damping of their own and are left out. 0×0 where the causes leave K and M as they are.
/// Source: a damping ratio is measured on the structure that is there; that one matrix D serves all
/// hypotheses is the other reading of the same number. Cost: 20 r³.
/// @throws NumericalFailure  M₁ is not positive definite
[[nodiscard]] Eigen::MatrixXd loaded_damping(const Structure& structure,
                                             const std::vector<Supposed>& causes);

}  // namespace chladni::diagnosis
