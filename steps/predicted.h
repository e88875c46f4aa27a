// Limits of responses that are predicted from a field of shapes.
#pragma once

#include <string>
#include <vector>

#include "steps/interpolation.h"

namespace chladni::steps {

/// The model from which the shapes were identified. @throws InvalidInput  there is none
[[nodiscard]] const IdentifiedModel& identified_of(const Interpolated& result);

/// Missing parts of the predicted responses and their band, a sentence each: modes without a scale,
/// the 1/s² term of modes at 0 Hz, the modes above the band.
/// @throws InvalidInput  as identified_of
[[nodiscard]] std::vector<std::string> left_out_of_predictions(const Interpolated& result);

}  // namespace chladni::steps
