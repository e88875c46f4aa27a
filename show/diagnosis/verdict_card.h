// The verdict of a diagnosis as the card that opens a report.
#pragma once

#include "io/report.h"
#include "io/vtu.h"
#include "steps/diagnosis.h"

namespace chladni::show {

/// Causes with place and size, the errors before and after with the noise, and what to do next.
[[nodiscard]] io::Card verdict_card(const steps::Diagnosed& diagnosed);

/// A marker of the kind "cause" at the place of each cause that has one.
[[nodiscard]] std::vector<io::Marker> cause_markers(const steps::Diagnosed& diagnosed);

/// Names of those markers, and of the channels in which a cause acts.
[[nodiscard]] std::vector<std::string> marked_names(const steps::Diagnosed& diagnosed);

}  // namespace chladni::show
