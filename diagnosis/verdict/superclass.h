// What can be said of a cause that no effect of the catalogue is: where it acts.
#pragma once

#include <optional>

#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/fit.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {

/// Tries one free complex function of frequency after the other (a sensor, an actuator, all
/// channels, a support that all see alike, a place of the surface), real mixing of the sensors or
/// of the actuators, free modal frequencies and dampings. The one that takes most of the excess
/// misfit, its own freedom discounted; none where it takes less than a tenth.
/// Cost: that of a scan and of one fit.
[[nodiscard]] std::optional<Superclass> superclass(const Problem& problem, const Fit& best);

}  // namespace chladni::diagnosis
