// The tables of a study that a cause adds or changes.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "steps/extend/extension.h"

namespace chladni::steps {

/// Keys and their values as TOML.
using Members = std::vector<std::pair<std::string, std::string>>;

inline constexpr auto kNoNegativeMass =
    "an attachment has no negative mass; less material is a matter of geometry";
inline constexpr auto kOtherChart =
    "the diagnosis looks at the body along another axis than the key";

/// A number in SI as a study writes it: lengths in mm, times in us, others in `unit`; without a
/// unit a bare number.
[[nodiscard]] std::string written(double value, std::string_view unit);

/// "[0, 0, 1]" as a study writes it; what is below rounding is 0.
[[nodiscard]] std::string direction_text(const Eigen::Vector3d& direction);

/// "z", or the normal of the chart as three numbers.
[[nodiscard]] std::string normal(const Extension& by);

/// Appends an [[attachment]] "diagnosed_NAME"; a number follows where the name is taken.
void append_attachment(const Extension& by, const std::string& at, const std::string& kind,
                       const std::string& name, const Members& more);

enum class Side { sensors, actuators };

/// A channel of the study and its table in the document.
struct ChannelTable {
  const study::Channel& channel;
  const study::TomlNode& table;
};

/// @throws InvalidInput  the study has no such channel
[[nodiscard]] ChannelTable channel_table(const Extension& by, Side side, const std::string& name);
/// The channel of a cause that has one. @throws InvalidInput  it has another number of channels
[[nodiscard]] ChannelTable only_channel(const Extension& by, Side side);
[[nodiscard]] std::vector<ChannelTable> all_sensors(const Extension& by);

/// Sets a key of a channel, with the cause and the old value as its comment.
void set_key(const Extension& by, const ChannelTable& of, const std::string& key,
             const std::string& value);

}  // namespace chladni::steps
