#include "io/measured/column_head.h"

#include <algorithm>
#include <initializer_list>
#include <numbers>
#include <string_view>

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
  if (unit.empty() || unit == "A" || unit == "in" || !is_measured_unit(unit)) return {column, ""};
  return {std::move(name), std::move(unit)};
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
