// Other possible places of a cause, and other possible extents.
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

/// A cause in one place may stand in the middle of what acts over an extent: a spring in a pad. A
/// start of the general effect at a peak of the scan need not lead there, the fitted place does.
/// For each effect of the catalogue that has an extent and of which the last cause of `fit` is a
/// special case: it in that cause's stead, with the numbers that both share. Of the usual extent
/// and those a width of its prior below and above it has the one that leaves the least misfit
/// beside the tolerances of `fit`. Cost: the responses of three states for each effect.
[[nodiscard]] std::vector<Supposed> spread_out(const Problem& problem, const Fit& fit,
                                               const std::vector<const Effect*>& catalogue);

}  // namespace chladni::diagnosis
