// What to measure next, to tell explanations of measured modes apart.
#pragma once

#include <vector>

#include "diagnosis/modes/proposals/outlook.h"
#include "diagnosis/proposal.h"

namespace chladni::diagnosis {

/// The measurements that tell the first explanation from the others, best first by
/// min(evidence, Constants::next_enough) less cost: a sensor or a known mass at places of the
/// surface, the total mass, a dimension, a channel exchanged or a mode measured again. At most one
/// of each kind; none that brings less than Constants::next_evidence. If none is left, what
/// confirms the first explanation, where it blames a channel or a mode.
///
/// The evidence is −ln Σ v exp(−separation) over the rivals with their shares v: it says how much
/// the likeliest of those that would remain loses. A sensor reads each mode's shape over its root
/// mean square at the present sensors; a mass m shifts ln f by −m φ²/2. Sizes and places have the
/// uncertainty of their fits. Source: Kailath, IEEE Trans. Commun. 15 (1967) for the distance.
/// Cost: one eigenproblem for each size of each explanation, and 100 places.
[[nodiscard]] std::vector<Proposal> next_measurements(const ModesProblem& problem,
                                                      const std::vector<WeighedFit>& explanations,
                                                      const MeasurementCosts& costs);

}  // namespace chladni::diagnosis
