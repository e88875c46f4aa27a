// An observer as text, files and a picture.
#pragma once

#include <string>

#include "show/run.h"
#include "steps/observed.h"

namespace chladni::show {

/// A length in mm, um, nm or pm; "drifts" where it is infinite, "-" where it is not known.
[[nodiscard]] std::string length_text(double metres);

/// The verdict first: how well the points are estimated, on recordings where there are any.
[[nodiscard]] std::string observer_table(const steps::Observed& observed);

/// The loop on the estimate beside the one on the sensors: what both leave at the points, margins.
[[nodiscard]] std::string loop_text(const steps::LoopTrial& trial);
[[nodiscard]] io::Json loop_json(const steps::LoopTrial& trial);

/// observe.json
[[nodiscard]] io::JsonObject observer_json(const steps::Observed& observed);

/// Leaves observe.json, observer.mat, observer.h and, of a replay, observer.png.
void leave_observer(const study::Study& study, const steps::Observed& observed, Run& run);

}  // namespace chladni::show
