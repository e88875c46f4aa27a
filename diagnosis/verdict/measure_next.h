// A proposal for the next measurement, to separate explanations that are about as good.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// The place of the surface where one more sensor separates `a` from `b` best, with the expected ln
/// of the Bayes factor: Σ |G_a − G_b|² / σ². For σ the larger one counts of two: the median noise
/// of the sensors to this actuator on this line, and the response times the least relative noise.
/// It is an upper bound, because the sizes are taken as known at their fitted values.
/// If both explanations only scale the body, the proposal is to weigh it. Cost: 60 lines of both
/// with fewer than 200 places.
[[nodiscard]] std::string measure_next(const Problem& problem, const Fit& a, const Fit& b);

/// The same for the best explanation and its likeliest rival. Where the best is sure against all
/// rivals (Constants::next_enough), nothing is left to tell apart. Empty if nothing is wrong, or if
/// there is no rival.
/// @param diagnosis  its verdict, best and rivals, which are fits of `found`
[[nodiscard]] std::string measure_next(const Problem& problem, const Found& found,
                                       const Diagnosis& diagnosis);

}  // namespace chladni::diagnosis
