// What an identified model says at other frequencies than those of its lines.
#pragma once

#include "steps/identification.h"

namespace chladni::steps {

/// m [rad/s], above the real axis: −ζω + jω √(1 − ζ²); 0 for a rigid-body mode.
[[nodiscard]] Eigen::VectorXcd poles(const IdentifiedModel& model);

/// Receptances between the channels of the fit, delays included.
/// @throws InvalidInput  a frequency is negative, or 0 beside modes at 0 Hz
[[nodiscard]] modal::FrfSet fitted_responses(const IdentifiedModel& model,
                                             const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::steps
