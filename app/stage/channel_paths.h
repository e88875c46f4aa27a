// What stands between a channel and its record.
#pragma once

#include <complex>

#include "app/study/study.h"
#include "modal/frf_set.h"

namespace chladni::app {

/// gain e^{−sτ} / (1 + s / ω_c) at s = 2πj f: by what the channel's record differs from what it
/// stands for.
[[nodiscard]] std::complex<double> path(const Channel& channel, double frequency_hz);

/// Whether a channel of the study says anything but gain 1, no delay and no low-pass.
[[nodiscard]] bool has_paths(const Study& study);

/// Responses of the structure as the study's channels record them, and back: divided by the paths
/// of sensors and of actuators. Variances follow. Channels go by name; others stay as they are.
[[nodiscard]] modal::FrfSet recorded(const Study& study, modal::FrfSet responses);
[[nodiscard]] modal::FrfSet without_paths(const Study& study, modal::FrfSet records);

}  // namespace chladni::app
