// Causes that would be one thing.
#pragma once

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// Whether two causes of a fit are in one place, of which one is a patch: together they are one
/// thing of another shape.
[[nodiscard]] bool overlaps_itself(const Structure& structure, const Fit& fit);

/// Whether a fit has the cause already: a channel has one gain, the body one modulus; what hangs in
/// a place may hang in several.
[[nodiscard]] bool is_there_already(const Structure& structure, const Fit& fit,
                                    const Supposed& cause);

}  // namespace chladni::diagnosis
