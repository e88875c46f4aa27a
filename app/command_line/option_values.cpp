#include "app/command_line/option_values.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "io/scan.h"

namespace chladni::app {
namespace {

std::optional<double> gigabytes(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 3> units{
      {{"MB", 1e-3}, {"GB", 1.0}, {"TB", 1e3}}};
  for (const auto& [unit, factor] : units) {
    if (!text.ends_with(unit)) continue;
    text.remove_suffix(unit.size());
    const auto number = io::number_in(io::trimmed(text));
    return number ? std::optional(factor * *number) : std::nullopt;
  }
  return io::number_in(text);
}

std::optional<double> seconds(std::string_view text) {
  if (const auto number = io::number_in(text)) return number;
  try {
    return quantity(text, "s");
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

std::string replaced(std::string& text, std::optional<double> value, std::string_view expected) {
  if (!value || !std::isfinite(*value) || !(*value > 0.0)) {
    return fmt::format("found \"{}\"; expected {}", text, expected);
  }
  text = fmt::to_string(*value);
  return {};
}

}  // namespace

std::string in_gigabytes(std::string& text) {
  return replaced(text, gigabytes(io::trimmed(text)), "a size such as 8, \"8 GB\" or \"500 MB\"");
}

std::string in_seconds(std::string& text) {
  return replaced(text, seconds(io::trimmed(text)), "a time such as 0.001 or \"1 ms\"");
}

}  // namespace chladni::app
