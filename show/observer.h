// An observer as text, files and a picture.
#pragma once

#include <optional>
#include <string>

#include "show/run.h"
#include "steps/observer_loop.h"
#include "steps/observer_replay.h"

namespace chladni::show {

/// A length in mm, um, nm or pm; "drifts" where it is infinite, "-" where it is not known.
[[nodiscard]] std::string length_text(double metres);

/// An observer and its trials.
struct ShownObserver {
  const steps::Observer& observer;
  std::optional<steps::Replay> replay;   ///< over recordings with a judge
  std::optional<steps::Replay> stated;   ///< with the noise as the study states it; none: it is so
  std::optional<steps::LoopTrial> loop;  ///< of [observer.loop]
};

/// The verdict first: how well the points are estimated, on recordings where there are any.
[[nodiscard]] std::string observer_table(const ShownObserver& shown);

/// The loop on the estimate beside the one on the sensors: what both leave at the points, margins.
[[nodiscard]] std::string loop_text(const steps::LoopTrial& trial);
[[nodiscard]] io::Json loop_json(const steps::LoopTrial& trial);

/// Leaves observe.json, observer.mat, observer.h and, of a replay, observer.png; warns of what the
/// estimate lacks.
void leave_observer(const study::Study& study, const ShownObserver& shown, Run& run);

}  // namespace chladni::show
