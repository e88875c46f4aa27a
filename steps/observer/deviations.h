// Deviations of what an observer estimates.
#pragma once

#include "steps/observer.h"

namespace chladni::steps {

/// Sets the deviations of the points and the unknown part of each mode, from the filter.
void set_deviations(Observer& observer);

}  // namespace chladni::steps
