// Before and after for the eye: modes, and errors over frequency and over the body.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identification/modal_fit.h"
#include "steps/diagnosis.h"

namespace chladni::steps {

/// Measured modes beside those of the study and, where it was solved, of the extended study. Where
/// a cause that the modes name is in the path of a channel, the MACs are those of the reduced
/// model.
/// @param fit    modes of `one.seen`
/// @param after  structure of the extended study; or null
[[nodiscard]] std::vector<diagnosis::ModeTold> modes_of_responses(
    const Diagnosed& one, const identification::ModalFit& fit, const diagnosis::Structure* after);

/// Errors of the predictions on all measured lines. The band is that of noise and tolerances, with
/// learned levels in their stead where there are any.
[[nodiscard]] ErrorsOverFrequency errors_over_frequency(const Diagnosed& one,
                                                        const diagnosis::Tolerances& tolerances);

}  // namespace chladni::steps
