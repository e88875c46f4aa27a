// A study is also a test: compares its expectations with the results.
#pragma once

#include <vector>

#include "stage/solution.h"

namespace chladni::steps {

/// An expectation beside the result.
struct JudgedExpectation {
  study::Expectation expected;
  double found = 0.0;  ///< in the unit of the expectation; NaN: there is no such mode
  bool met = false;
};

/// @throws InvalidInput  the study expects nothing
void require_expectations(const study::Study& study);

/// Each expectation of the study beside the result; shows them.
[[nodiscard]] std::vector<JudgedExpectation> judged(const study::Study& study,
                                                    const stage::Solution& solution,
                                                    stage::Work& work);
/// @throws NumericalFailure  some are not met (their number), or the modes do not satisfy their
///                           equation, which is expected of every study
void require_met(const study::Study& study, const std::vector<JudgedExpectation>& all,
                 const stage::Solution& solution);

/// All of it. @throws as the three
void judge(const study::Study& study, const stage::Solution& solution, stage::Work& work);

}  // namespace chladni::steps
