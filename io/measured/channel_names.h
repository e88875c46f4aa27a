// Which sensor and which actuator a column is of.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chladni::io {

using ChannelPair = std::pair<std::string, std::string>;  ///< sensor, actuator

/// "y1/u2" is cut at its stroke. Without one, "y1u2" is cut where a known sensor's name ends and a
/// known actuator's begins; where none is known, between letters with digits and letters with
/// digits. A sign between the two ("y1_u2", "y1->u2") is left out.
/// @throws InvalidInput  says how many ways there are
[[nodiscard]] ChannelPair channel_pair(std::string_view word,
                                       const std::vector<std::string>& sensors,
                                       const std::vector<std::string>& actuators);

}  // namespace chladni::io
