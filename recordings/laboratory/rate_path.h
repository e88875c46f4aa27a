// What velocities and accelerations take from the forces themselves, without any state.
#pragma once

#include <Eigen/Core>

#include "recordings/laboratory/plant.h"

namespace chladni::recordings {

/// Samples by which an output may depend on forces that come after it: the instrument's filter is
/// as long on both sides.
inline constexpr Eigen::Index kRateAhead = 5;

/// D₀ u + D₁ u̇ + D₂ ü of forces that are held between samples, as an instrument records it that
/// folds nothing back: (D₀ + jω D₁ − ω² D₂) sin x / x e^{−jx}, x = ωT/2, and the delay. The error
/// is below 1 % up to an eighth of the sampling frequency. The forces are 0 before the first sample
/// and keep their last value after the last.
/// @param force  N×q, N samples
/// @return N×p
[[nodiscard]] Eigen::MatrixXd along_rate_path(const RatePath& path, const SampledDelay& delay,
                                              double sample_time_s, const Eigen::MatrixXd& force);

}  // namespace chladni::recordings
