// Kinds with nearly the same effect ("twins"): a delay and a first-order low-pass, a tilted channel
// and a moved channel.
#pragma once

#include "simulators/hidden/hidden_effect.h"

namespace chladni::simulators {

/// The distance of the truth from its nearest twin: Σ |twin − exact|² / σ² at the twin's best size,
/// as HiddenCase::evidence_there. A twin exchanges one effect: a delay for a low-pass of the same
/// channels or the reverse, or the tilts for moves. The distance is infinite where no effect has a
/// twin. Below 5 no method can distinguish the two.
[[nodiscard]] double evidence_apart(const HiddenCase& made);

}  // namespace chladni::simulators
