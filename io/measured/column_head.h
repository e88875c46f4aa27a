// Names and units in the first line of a table of measured data.
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace chladni::io {

/// The name of a column, and what stands in brackets behind it: {"Time", "ms"} of "Time [ms]" and
/// of "Time (ms)". The second is empty where there are no brackets, and the first is then the
/// whole.
[[nodiscard]] std::pair<std::string, std::string> name_and_unit(const std::string& column);

/// As `name_and_unit`, of the column of a channel or a response: brackets that hold no unit of
/// sensors, forces or responses belong to the name, and so do "(A)" and "(in)".
[[nodiscard]] std::pair<std::string, std::string> channel_and_unit(const std::string& column);

/// How many s 1 of a column of times is: "time_s", "time", "t", "t_s", also "time_ms" and
/// "Time [ms]". None: it is no such column, or in another unit.
[[nodiscard]] std::optional<double> seconds_of_column(const std::string& column);

/// How many Hz 1 of a column of frequencies is: "freq_hz", "frequency_hz", "f_hz", "freq",
/// "frequency", "f", also "freq_khz", "Frequency [kHz]" and "freq [rad/s]". None: it is no such
/// column, or in another unit.
[[nodiscard]] std::optional<double> hertz_of_column(const std::string& column);

}  // namespace chladni::io
