// Other places where a cause may be.
#pragma once

#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// A fit that moves a place goes to the nearest of its minima, of which a cause that hangs on a
/// body has about as many as the modes have fields. This takes the score test (hints.h) of its size
/// all over the surface, with its other numbers as they are and with all tolerances free, and gives
/// the cause where it promises about as much as where it is, most promising first, at most two.
/// None for a cause without a place. Cost: a slope per deviation and a hundred and fifty more.
/// @param without  what the cause was added to
[[nodiscard]] std::vector<Supposed> elsewhere(const Problem& problem, const Fit& without,
                                              const Supposed& cause);

}  // namespace chladni::diagnosis
