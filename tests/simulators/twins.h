// Truths that another kind does nearly the same as: a delay and a first-order low-pass, a tilted
// channel and one in another place.
#pragma once

#include "simulators/hidden_effect.h"

namespace chladni::simulators {

/// How far the truth is from its likest twin, each delay exchanged for a low-pass of the same
/// channels or back, each tilt for a move: Σ |twin − exact|² / σ² at the twin's best size, as
/// HiddenCase::evidence_there; infinite where nothing hidden has a twin. Below 5 no method tells
/// the two apart.
[[nodiscard]] double evidence_apart(const HiddenCase& made);

}  // namespace chladni::simulators
