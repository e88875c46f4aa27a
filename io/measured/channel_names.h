// Finds the sensor and the actuator in the name of a column.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chladni::io {

using ChannelPair = std::pair<std::string, std::string>;  ///< sensor, actuator

/// "y1/u2" is divided at the slash. Without a slash, "y1u2" is divided where the name of a known
/// sensor ends and the name of a known actuator begins. Where no names are known, it is divided
/// between letters with digits and letters with digits. A sign between the two names ("y1_u2",
/// "y1->u2") is removed.
/// @throws InvalidInput  there is not exactly one way; says how many ways there are
[[nodiscard]] ChannelPair channel_pair(std::string_view word,
                                       const std::vector<std::string>& sensors,
                                       const std::vector<std::string>& actuators);

}  // namespace chladni::io
