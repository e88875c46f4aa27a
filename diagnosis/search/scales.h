// Numbers of the whole body that nearly do the same: modulus, density, thickness, size, orthotropy,
// and the scale of all responses.
#pragma once

#include <vector>

#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// Where the best of the last fits has such causes, fits each of the catalogue's that has one number
/// in place of all of them, and keeps the fits. A search that takes the errors of the shapes as
/// noise tells these causes apart as its variances have it: a density that is off was a modulus and
/// a scale of all responses there, by 36 in ln evidence, and is the better one here, by 1.4.
/// Cost: a fit for each of these effects.
/// @return true if one of them is the best fit now
bool add_scales(const Problem& problem, const std::vector<const Effect*>& catalogue, Found& found);

}  // namespace chladni::diagnosis
