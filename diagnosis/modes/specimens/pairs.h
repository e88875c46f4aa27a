// Pairs of measured and simulated modes of a specimen whose model is near.
#pragma once

#include "diagnosis/modes/matching.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

/// Σ over the measured modes of (ln f_measured / f_model)², in units of the error that is usual for
/// a pair and bounded. A mode without partner counts as much as the bound.
[[nodiscard]] double square_misfit(const MeasuredModes& measured, const RecordedModes& model,
                                   const Matching& matching);

/// Pairs in the order of the frequencies, on both sides: the alignment of least misfit by dynamic
/// programming. A measured mode may be stray, a simulated one between the measured ones may be
/// unseen, at a cost. For modes that are seen at one or two channels, whose shapes tell nothing.
/// Cost: n·m for n measured and m simulated modes.
[[nodiscard]] Matching pairs_in_order(const MeasuredModes& measured, const RecordedModes& model);

/// The pairs of least misfit: in order where at most two channels see the modes, otherwise among
/// the ways in which `problem` pairs them.
[[nodiscard]] Matching nearest_pairs(const ModesProblem& problem, const MeasuredModes& measured,
                                     const RecordedModes& model);

}  // namespace chladni::diagnosis
