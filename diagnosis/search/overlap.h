// Causes that would be one and the same.
#pragma once

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// True if two causes of a fit lie in one place and one of them is a patch: together they are one
/// patch of another shape.
[[nodiscard]] bool overlaps_itself(const Structure& structure, const Fit& fit);

/// True if a fit already has the cause: a channel has one gain, the body one modulus. Two
/// attachments may hang in one place.
[[nodiscard]] bool is_there_already(const Structure& structure, const Fit& fit,
                                    const Supposed& cause);

}  // namespace chladni::diagnosis
