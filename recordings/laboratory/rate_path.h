// What velocities and accelerations take from the forces themselves, without any state.
#pragma once

#include <Eigen/Core>

#include "recordings/laboratory/plant.h"

namespace chladni::recordings {

/// Samples by which an output may depend on forces that come after it: the instrument's filter is
/// as long on both sides.
inline constexpr Eigen::Index kRateAhead = 24;

/// What the outputs that are no displacements take beside the sampled states, for an instrument
/// whose filter lets nothing above half the sampling frequency pass. D₀ u + D₁ u̇ + D₂ ü of forces
/// that are held between samples: (D₀ + jω D₁ − ω² D₂) sin x / x e^{−jx}, x = ωT/2, and the delay.
/// And what the filter takes off the sampled states, which would be folded back: as a force u sets
/// in, the derivative of order m + 1 of such an output changes by C Aᵐ B u; of blocks whose poles
/// lie below a quarter of the sampling frequency m = 0 to 3 are taken, else m = 0. The filter is
/// sinc s under a window of Blackman and Harris (Harris 1978) of kRateAhead samples to each side.
/// For poles below a tenth of the sampling frequency the error is below 1e-3 up to 0.4 of it, and
/// 3e-4 up to a quarter. The forces are 0 before the first sample and keep their last value after
/// the last.
/// @param plant  with a path of rates
/// @param force  N×q, N samples
/// @return N×p
[[nodiscard]] Eigen::MatrixXd along_rate_path(const Plant& plant, const SampledDelay& delay,
                                              double sample_time_s, const Eigen::MatrixXd& force);

}  // namespace chladni::recordings
