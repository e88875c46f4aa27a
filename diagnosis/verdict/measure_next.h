// A proposal for the next measurement, to separate two equally good explanations.
#pragma once

#include <string>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// The place of the surface where one more sensor separates `a` from `b` best, with the expected ln
/// of the Bayes factor: Σ |G_a − G_b|² / σ², where σ is the median relative noise of the
/// measurement. It is an upper bound, because the sizes are taken as known at their fitted values.
/// If both explanations only scale the body, the proposal is to weigh it. Cost: 60 lines of both
/// with fewer than 200 places.
[[nodiscard]] std::string measure_next(const Problem& problem, const Fit& a, const Fit& b);

}  // namespace chladni::diagnosis
