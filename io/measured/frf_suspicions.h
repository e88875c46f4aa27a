// Finds data in measured responses that look wrong.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::io {

/// Reports lines that are not measured or zero, responses that are zero or equal to another one,
/// and responses whose phase turns the wrong way ("conjugated"; with e^{+jωt} the phase falls
/// around a resonance for all channels). It also reports responses of collocated channels that
/// start in the wrong half plane ("sign turned"). Channels of one node and axis are collocated, and
/// so are the pairs named here (sensor, actuator). Each sentence names its place. Cost: linear.
[[nodiscard]] std::vector<std::string> suspicions(
    const modal::FrfSet& set,
    const std::vector<std::pair<std::string, std::string>>& collocated = {});

/// The direction in which G turns: Σ Im(conj(G_k) G_{k+1}) divided by the sum of the magnitudes, in
/// [−1, 1]. It is near −1 for a structure and near +1 for a conjugated response. 0: too few lines.
[[nodiscard]] double turning(const modal::FrfSet& set, Eigen::Index output, Eigen::Index input);

/// The side of the real axis of a response, as a receptance: Σ Im G / Σ |Im G|. It is −1 for
/// collocated channels and +1 where their sign is turned. @param conjugated  use conj(G) instead
[[nodiscard]] double side(const modal::FrfSet& set, Eigen::Index output, Eigen::Index input,
                          bool conjugated = false);

}  // namespace chladni::io
