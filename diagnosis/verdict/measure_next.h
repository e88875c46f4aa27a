// What to measure so that two explanations which are equally good no longer are.
#pragma once

#include <string>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// The place of the surface where one more sensor would tell `a` from `b` best, and by how much: in
/// the mean, ln of the Bayes factor is Σ |G_a − G_b|² / σ², σ being the median relative noise of
/// what was measured. What both leave open (their sizes are taken as found) makes it an upper
/// bound. Where both scale the body, weighing it is what decides.
/// Cost: 60 lines of both with up to 100 places.
[[nodiscard]] std::string measure_next(const Problem& problem, const Fit& a, const Fit& b);

}  // namespace chladni::diagnosis
