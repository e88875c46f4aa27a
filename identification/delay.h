// The time delay of the hardware: an estimate from the phase, its deviation, and its removal.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::identification {

struct DelayEstimate {
  double delay_s = 0.0, std_s = 0.0;  ///< infinite deviation: not known
  std::string how;                    ///< for a person: the basis of the estimate
};

/// One delay of all responses, without a model. A lightly damped structure of real modes answers
/// away from its modes with the phases 0 and 180°, so the phase of G² is −2ωτ. Damping looks like
/// delay (2ζ/ω_m at the static end). The deviation comes from how the responses differ and does not
/// contain this bias: the result is a first value. One response alone tells no deviation.
/// @param longest_s  the longest delay that is searched for
/// @throws InvalidInput  no finite line above 0 Hz
[[nodiscard]] DelayEstimate phase_delay(const modal::FrfSet& set, double longest_s);

/// One delay of all responses, fitted with real residues at given poles [rad/s, Im > 0], rigid-body
/// modes and a constant: maximum likelihood by separable least squares (Golub and Pereyra 1973, in
/// Kaufman's form), from `start_s`. The deviation is the Cramér-Rao bound for given poles. It uses
/// the stated variances; without them, or where all are 0, it uses the residual, as if all lines
/// had equal noise.
/// Cost: responses·lines·poles² per step.
/// @throws InvalidInput      fewer lines than unknowns, a pole that does not decay
/// @throws NumericalFailure  no convergence: the start is more than half a turn of the highest line
///                           away, or the poles are not the data's
[[nodiscard]] DelayEstimate delay_at_poles(const modal::FrfSet& set, const Eigen::VectorXcd& pole,
                                           bool rigid_modes, double start_s = 0.0);

/// The same responses without a delay. If a sample time is given, the effect of a zero-order hold
/// is removed as well: half a sample of delay and the magnitude sin x / x, x = ωT/2. The variances
/// are changed in the same way.
/// @throws InvalidInput  a line beyond half the sampling frequency
[[nodiscard]] modal::FrfSet without_delay(const modal::FrfSet& set, double delay_s,
                                          double hold_sample_time_s = 0.0);

}  // namespace chladni::identification
