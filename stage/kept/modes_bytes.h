// Modes as bytes for the cache.
#pragma once

#include <string>
#include <string_view>

#include "stage/kept/solved_modes.h"

namespace chladni::stage {

/// The bytes of all that `solved` holds, but for its damping ratios, which are the study's.
[[nodiscard]] std::string bytes_of(const SolvedModes& solved);

/// The modes of such bytes for a system of `degrees_of_freedom` free ones.
/// @throws InvalidInput  other bytes, sizes that do not agree, numbers that are not finite,
///                       frequencies that do not ascend
[[nodiscard]] SolvedModes modes_of_bytes(std::string_view bytes, Eigen::Index degrees_of_freedom);

/// All that the modes of a model depend on, but for how many are wanted: 64 hexadecimal digits.
[[nodiscard]] std::string fingerprint_of(const Model& model,
                                         const std::vector<fem::Support>& supports,
                                         const ModesRequest& request);

}  // namespace chladni::stage
