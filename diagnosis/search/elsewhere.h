// Other possible places of a cause.
#pragma once

#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// A fit that moves a place reaches only the nearest local minimum, and a cause attached to a body
/// has about one minimum per antinode of the modes. This function makes the score test (hints.h) of
/// the cause's size all over the surface, with its other numbers fixed and with all tolerances
/// free. It returns the cause at places that promise about as much evidence as its own place, the
/// most promising first, at most two. Empty for a cause without a place. Cost: a slope per
/// deviation and a hundred and fifty more.
/// @param without  the fit without the cause
[[nodiscard]] std::vector<Supposed> elsewhere(const Problem& problem, const Fit& without,
                                              const Supposed& cause);

}  // namespace chladni::diagnosis
