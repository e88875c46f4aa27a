// From fits of modal data to the answer.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/modes/search/modes_search.h"

namespace chladni::diagnosis {

/// Verdict, causes with probabilities, levels and modes before and after. Cause::log_evidence_gain
/// is relative to the best fit that was found with the other causes. Where that was dropped because
/// its last cause is not significant, it is relative to the structure as it is, and an upper bound.
/// A note says where the order of the explanations is not certain.
[[nodiscard]] Diagnosis answer(const ModesProblem& problem, const ModesFound& found,
                               const DiagnosisOptions& options);

/// True where the level of one class leaves no model of this structure believed.
[[nodiscard]] bool is_at_limit(const ModesProblem& problem, const ModesFit& fit, ErrorClass of);

}  // namespace chladni::diagnosis
