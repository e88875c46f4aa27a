// A study is also a test: compares its expectations with the results.
#pragma once

#include "stage/solution.h"

namespace chladni::steps {

/// Shows each expectation beside the result.
/// @throws InvalidInput  the study expects nothing
/// @throws NumericalFailure  some are not met (their number), after all were shown
void judge(const study::Study& study, const stage::Solution& solution, stage::Work& work);

}  // namespace chladni::steps
