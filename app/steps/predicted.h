// What responses predicted from a field of shapes do not contain.
#pragma once

#include <string>
#include <vector>

#include "app/interpolation.h"

namespace chladni::app {

/// The model that the shapes were identified with. @throws InvalidInput  there is none
[[nodiscard]] const IdentifiedModel& identified_of(const Interpolated& result);

/// What the predicted responses and their band lack, a sentence each: modes without a scale, the
/// term in 1/s² of modes at 0 Hz, the modes above the band.
/// @throws InvalidInput  as identified_of
[[nodiscard]] std::vector<std::string> left_out_of_predictions(const Interpolated& result);

}  // namespace chladni::app
