// Deviations of a structure that give it measured modes: where a fit of responses may start.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/fit/deviations.h"
#include "diagnosis/measured_modes.h"

namespace chladni::diagnosis {

/// The most probable deviations (unit normal prior each) with which the structure has the measured
/// frequencies and damping ratios. A response tells nothing of a resonance that is some bandwidths
/// off, so a descent from the simulation may end far from the data; from here it is near them.
/// Modes are paired by shape and frequency (modes/matching.h); a mode without a partner counts for
/// nothing. A frequency counts to Constants::start_bandwidth of its half-power bandwidth, a damping
/// ratio to Constants::start_damping, or to their own deviations if these are larger: the fit of
/// the responses finds the rest. Deviations that change no mode stay 0. Gauss and Newton with
/// first-order changes of the modes. Cost: per round one eigenproblem of the structure's modes, and
/// two states of it for each deviation.
/// @param measured  with the channels of the structure, in its order
/// @throws NumericalFailure  a structure without modes
[[nodiscard]] Eigen::VectorXd deviations_by_modes(const Structure& structure,
                                                  const std::vector<Deviation>& deviations,
                                                  const MeasuredModes& measured);

}  // namespace chladni::diagnosis
