// The time that hardware takes: found from the phase, with its deviation, and taken away.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::identification {

struct DelayEstimate {
  double delay_s = 0.0, std_s = 0.0;
  std::string how;  ///< for a person: on what it rests
};

/// One delay of all responses without a model: away from its modes a lightly damped structure of
/// real modes answers with the phases 0 and 180°, so the phase of G² is −2ωτ. Damping looks like
/// delay (2ζ/ω_m at the static end), and the deviation, from how responses differ, holds no such
/// bias: a first value.
/// @param longest_s  the longest that is looked for
/// @throws InvalidInput  no finite line above 0 Hz
[[nodiscard]] DelayEstimate phase_delay(const modal::FrfSet& set, double longest_s);

/// One delay of all responses beside real residues at given poles [rad/s, Im > 0], rigid-body modes
/// and a constant: maximum likelihood by separable least squares (Golub and Pereyra 1973, in
/// Kaufman's form), from `start_s`. Deviation: the Cramér-Rao bound given the poles, by the stated
/// variances; where there are none from the residual, as if all lines had equal noise.
/// Cost: responses·lines·poles² per step.
/// @throws InvalidInput      fewer lines than unknowns, a pole that does not decay
/// @throws NumericalFailure  no convergence: the start is more than half a turn of the highest line
///                           away, or the poles are not the data's
[[nodiscard]] DelayEstimate delay_at_poles(const modal::FrfSet& set, const Eigen::VectorXcd& pole,
                                           bool rigid_modes, double start_s = 0.0);

/// The same responses less a delay and, where a sample time is given, less what a zero-order hold
/// does: half a sample of delay and the magnitude sin x / x, x = ωT/2. Variances follow.
/// @throws InvalidInput  a line beyond half the sampling frequency
[[nodiscard]] modal::FrfSet without_delay(const modal::FrfSet& set, double delay_s,
                                          double hold_sample_time_s = 0.0);

}  // namespace chladni::identification
