// How the frequencies of a model follow its constants.
#pragma once

#include <Eigen/Core>

#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

/// d ln f / dx of each mode, n×c, by Rayleigh's quotient: φᵀ (dK − λ dM) φ / 2λ with φᵀ M φ = 1.
/// @param fit    its constants; `model` has the modes with them, without causes
[[nodiscard]] Eigen::MatrixXd frequency_slopes(const ModesProblem& problem, const ModesFit& fit,
                                               const RecordedModes& model);

/// The same for the length of a thin body along u or v, in ln: curvatures along it go as its power
/// −2, twists as −1, areas as 1. Shear and rotary inertia are taken to do likewise.
/// @pre structure.directional is not empty
[[nodiscard]] Eigen::VectorXd length_slopes(const ModesProblem& problem, const ModesFit& fit,
                                            const RecordedModes& model, bool along_u);

}  // namespace chladni::diagnosis
