// The location of a cause that is not in the catalogue.
#pragma once

#include <optional>

#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/fit.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {

/// Tries one free complex function of frequency after the other (on a sensor, an actuator, all
/// channels, a support that all see alike but for the signs of their directions, a place of the
/// surface), then real mixing of the sensors or of the actuators, then free modal frequencies and
/// dampings. Returns the one that removes most of the excess misfit, after its own free numbers are
/// subtracted; none if it removes less than a tenth. Cost: that of a scan and of one fit.
[[nodiscard]] std::optional<Superclass> superclass(const Problem& problem, const Fit& best);

}  // namespace chladni::diagnosis
