#include "io/measured/column_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <numbers>
#include <string_view>

#include "base/error.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

// Where the bracket that ends a text is opened; npos: there is none.
std::size_t opening_bracket(const std::string& text) {
  if (text.empty() || (text.back() != ']' && text.back() != ')')) return std::string::npos;
  const char close = text.back();
  const char open = close == ']' ? '[' : '(';
  int depth = 0;
  for (std::size_t at = text.size(); at-- > 0;) {
    if (text[at] == close) ++depth;
    if (text[at] == open && --depth == 0) return at;
  }
  return std::string::npos;
}

// The unit in the line below the names; "1" where it says that there is no dimension.
std::string unit_below(const CsvTable& table, std::size_t column) {
  if (table.units.empty()) return "";
  auto unit = bare_unit(table.units[column]);
  return unit == "-" ? "1" : unit;
}

// The unit behind the name of a column, and below it. @param behind  empty: none
std::string one_unit(const CsvTable& table, std::size_t column, const std::string& behind) {
  const auto below = unit_below(table, column);
  if (below.empty()) return behind;
  const auto& whole = table.names[column];
  const auto place = table.file + ": line " + fmt::to_string(table.units_line) + ": ";
  require(behind.empty() || bare_unit(behind) == below,
          place + "the unit below " + shown(whole) + " is " + shown(below));
  require(below == "1" || is_measured_unit(below),
          place + "the unit " + shown(below) + " of " + shown(whole) +
              " is none that is known; expected one such as m/s^2, g, N or um/N");
  return below;
}

// Whether a name is one of these, in letters of any size where it is a word.
bool is_one_of(const std::string& name, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(names, [&](std::string_view one) {
    return name == one || (one.size() > 1 && upper(name) == upper(one));
  });
}

}  // namespace

std::pair<std::string, std::string> name_and_unit(const std::string& column) {
  const auto at = opening_bracket(column);
  if (at == std::string::npos || at == 0) return {column, ""};
  const std::string name(trimmed(std::string_view(column).substr(0, at)));
  const auto inner = std::string_view(column).substr(at + 1, column.size() - at - 2);
  if (name.empty() || trimmed(inner).empty()) return {column, ""};
  return {name, std::string(trimmed(inner))};
}

std::pair<std::string, std::string> channel_and_unit(const std::string& column) {
  auto [name, unit] = name_and_unit(column);
  unit = bare_unit(unit);
  if (unit.empty() || unit == "A" || unit == "in" || !is_measured_unit(unit)) return {column, ""};
  return {std::move(name), std::move(unit)};
}

std::pair<std::string, std::string> channel_and_unit(const CsvTable& table, std::size_t column) {
  auto [name, unit] = channel_and_unit(table.names[column]);
  return {std::move(name), one_unit(table, column, unit)};
}

std::string response_unit(const CsvTable& table, std::size_t column) {
  auto behind = channel_and_unit(table.names[column]).second;
  if (force_unit(behind)) behind.clear();  // the actuator "u [N]"
  auto unit = one_unit(table, column, behind);
  if (!force_unit(unit)) return unit;
  throw InvalidInput(table.file + ": line " + fmt::to_string(table.units_line) + ": the unit " +
                     shown(unit) + " of " + shown(table.names[column]) +
                     " is of a force; expected that of a motion, or of a motion over a force");
}

std::string whole_head(const CsvTable& table, std::size_t column) {
  const auto below = unit_below(table, column);
  const auto& name = table.names[column];
  const bool is_there = below.empty() || bare_unit(name_and_unit(name).second) == below;
  return is_there ? name : name + " [" + below + "]";
}

bool is_unit_of_column(const std::string& word) {
  const auto unit = bare_unit(word);
  const auto is_of = [&](const char* si) { return factor_of(unit, si).has_value(); };
  return is_measured_unit(unit) || is_of("Hz") || is_of("rad/s") || is_of("s");
}

std::optional<double> seconds_of_column(const std::string& column) {
  const auto [name, unit] = name_and_unit(column);
  if (unit.empty() && is_one_of(name, {"time_ms", "t_ms"})) return 1e-3;
  const bool is_stated = is_one_of(name, {"time_s", "t_s"});
  if (!is_stated && !is_one_of(name, {"time", "t"})) return std::nullopt;
  if (unit.empty()) return 1.0;
  const auto seconds = factor_of(unit, "s");
  return is_stated && seconds != 1.0 ? std::nullopt : seconds;
}

std::optional<double> hertz_of_column(const std::string& column) {
  const auto [name, unit] = name_and_unit(column);
  if (unit.empty() && is_one_of(name, {"freq_khz", "frequency_khz", "f_khz"})) return 1e3;
  const bool is_stated = is_one_of(name, {"freq_hz", "frequency_hz", "f_hz"});
  if (!is_stated && !is_one_of(name, {"freq", "frequency", "f"})) return std::nullopt;
  if (unit.empty()) return 1.0;
  const auto hertz = factor_of(unit, "Hz");
  if (is_stated) return hertz == 1.0 ? hertz : std::nullopt;
  const auto angular = factor_of(unit, "rad/s");
  return angular ? *angular / (2.0 * std::numbers::pi) : hertz;
}

}  // namespace chladni::io
