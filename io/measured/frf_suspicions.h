// What in measured responses looks wrong.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::io {

/// Lines that were not measured or are zero, responses that are zero or the same as another,
/// responses that turn the wrong way ("conjugated": around a resonance the phase of e^{+jωt} falls,
/// whatever the channels) or of collocated channels that start in the wrong half plane ("sign
/// turned"). Collocated are channels of one node and axis, and those named here (sensor, actuator).
/// Each sentence names its place. Cost: linear.
[[nodiscard]] std::vector<std::string> suspicions(
    const modal::FrfSet& set,
    const std::vector<std::pair<std::string, std::string>>& collocated = {});

/// Which way G turns: Σ Im(conj(G_k) G_{k+1}) over Σ of its size, in [−1, 1]; near −1 for a
/// structure and +1 where the response was conjugated. 0: no two lines.
[[nodiscard]] double turning(const modal::FrfSet& set, Eigen::Index output, Eigen::Index input);

/// On which side of the real axis a response lies, as a receptance: Σ Im G over Σ |Im G|, −1 for
/// collocated channels and +1 where their sign is turned. @param conjugated  take conj(G) instead
[[nodiscard]] double side(const modal::FrfSet& set, Eigen::Index output, Eigen::Index input,
                          bool conjugated = false);

}  // namespace chladni::io
