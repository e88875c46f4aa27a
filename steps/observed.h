// An observer of a study and its trials: on recordings, and in a loop.
#pragma once

#include <optional>

#include "steps/observer_loop.h"
#include "steps/observer_replay.h"

namespace chladni::steps {

struct Observed {
  Observer observer;
  std::optional<Replay> replay;   ///< over recordings with a judge
  std::optional<Replay> stated;   ///< with the noise as the study states it; none: it is so
  std::optional<LoopTrial> loop;  ///< of [observer.loop]
};

/// @throws InvalidInput  there is no [observer], nothing to identify a model from, or a file that
///                       is named does not exist: before minutes of solving
void require_observer(const study::Study& study);

/// Identifies the model, interpolates its shapes with the study's first method (none: by the
/// dynamic residual), designs the filter, learns its noise where there are recordings, and tries it
/// on them and in the loop that the study asks for. What the estimate lacks is a warning.
/// @throws as require_observer and its steps
[[nodiscard]] Observed observed(const study::Study& study, const stage::Solution& solution,
                                stage::Work& work);

}  // namespace chladni::steps
