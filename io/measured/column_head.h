// Names and units in the first line of a table of measured data.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "io/bytes/csv_table.h"

namespace chladni::io {

/// The name of a column, and what stands in brackets behind it: {"Time", "ms"} of "Time [ms]" and
/// of "Time (ms)". The second is empty where there are no brackets, and the first is then the
/// whole.
[[nodiscard]] std::pair<std::string, std::string> name_and_unit(const std::string& column);

/// As `name_and_unit`, of the column of a channel or a response: brackets that hold no unit of
/// sensors, forces or responses belong to the name, and so do "(A)" and "(in)".
[[nodiscard]] std::pair<std::string, std::string> channel_and_unit(const std::string& column);

/// As `channel_and_unit`, with the unit that stands below the name; "1" of a "-" there.
/// @throws InvalidInput  two units of one column that differ, a unit of a channel that is not known
[[nodiscard]] std::pair<std::string, std::string> channel_and_unit(const CsvTable& table,
                                                                   std::size_t column);

/// The unit of a response, in a table with a line of units. That of a force behind the name belongs
/// to the actuator, "re_y/u [N]".
/// @throws InvalidInput  as `channel_and_unit`, a unit of a force
[[nodiscard]] std::string response_unit(const CsvTable& table, std::size_t column);

/// The name of a column, with the unit that stands below it in brackets: "Time [ms]".
[[nodiscard]] std::string whole_head(const CsvTable& table, std::size_t column);

/// Whether a word is a unit that may stand below the name of a column: "Hz", "ms", "[g]", "um/N".
[[nodiscard]] bool is_unit_of_column(const std::string& word);

/// How many s 1 of a column of times is: "time_s", "time", "t", "t_s", also "time_ms" and
/// "Time [ms]". None: it is no such column, or in another unit.
[[nodiscard]] std::optional<double> seconds_of_column(const std::string& column);

/// How many Hz 1 of a column of frequencies is: "freq_hz", "frequency_hz", "f_hz", "freq",
/// "frequency", "f", also "freq_khz", "Frequency [kHz]" and "freq [rad/s]". None: it is no such
/// column, or in another unit.
[[nodiscard]] std::optional<double> hertz_of_column(const std::string& column);

}  // namespace chladni::io
