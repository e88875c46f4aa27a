// The path between a channel and its record.
#pragma once

#include <complex>

#include "modal/frf_set.h"
#include "study/study.h"

namespace chladni::stage {

/// gain e^{−sτ} / (1 + s / ω_c) at s = 2πj f: the factor between a channel and its record.
[[nodiscard]] std::complex<double> path(const study::Channel& channel, double frequency_hz);

/// True if a channel of the study has a gain other than 1, a delay or a low-pass.
[[nodiscard]] bool has_paths(const study::Study& study);

/// Responses of the structure as the study's channels record them, and the inverse: divided by the
/// paths of sensors and of actuators. Variances are scaled too. Channels match by name; others do
/// not change.
[[nodiscard]] modal::FrfSet recorded(const study::Study& study, modal::FrfSet responses);
[[nodiscard]] modal::FrfSet without_paths(const study::Study& study, modal::FrfSet records);

}  // namespace chladni::stage
