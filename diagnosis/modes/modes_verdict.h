// From fits of modal data to the answer.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/modes/search/modes_search.h"

namespace chladni::diagnosis {

/// Verdict, causes with probabilities, levels and modes before and after.
[[nodiscard]] Diagnosis answer(const ModesProblem& problem, const ModesFound& found,
                               const DiagnosisOptions& options);

}  // namespace chladni::diagnosis
