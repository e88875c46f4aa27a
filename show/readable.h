// Numbers of effects in readable units.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

namespace chladni::show {

/// Factor from the SI value, and the unit after it: mm, us, g, %, mrad.
struct Readable {
  double scale = 1.0;
  std::string unit;
};

[[nodiscard]] inline Readable readable(std::string_view name, std::string_view unit, double value) {
  if (unit == "m") return {1e3, "mm"};
  if (unit == "s") return {1e6, "us"};
  if (unit == "kg" && std::abs(value) < 0.1) return {1e3, "g"};
  if (unit == "rad") return {1e3, "mrad"};
  if (unit != "1") return {1.0, std::string(unit)};
  const bool factor = name == "factor" || name == "share" || name == "damping_ratio";
  return factor ? Readable{1.0, ""} : Readable{100.0, "%"};
}

/// The same for a constant of a study: GPa, mm, g or kg.
/// @param size  the SI value that decides between g and kg
[[nodiscard]] inline Readable readable_constant(std::string_view unit, double size = 0.0) {
  if (unit == "Pa") return {1e-9, "GPa"};
  if (unit == "m") return {1e3, "mm"};
  if (unit == "kg" && std::abs(size) < 1.0) return {1e3, "g"};
  return {1.0, unit == "1" ? "" : std::string(unit)};
}

/// Two digits, or all before the point: "0.12", "9.8", "200" instead of "2e+02".
[[nodiscard]] inline std::string two_digits(double value) {
  const double size = std::abs(value);
  return size >= 99.5 && size < 1e6 ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value);
}

/// A standard deviation in this format of fmt; "unknown" where it is not finite.
[[nodiscard]] inline std::string deviation_text(double deviation,
                                                std::string_view format = "{:.2g}") {
  return std::isfinite(deviation) ? fmt::format(fmt::runtime(format), deviation) : "unknown";
}

/// "1 sensor", "2 sensors".
[[nodiscard]] inline std::string how_many(std::ptrdiff_t count, std::string_view thing) {
  return fmt::to_string(count) + " " + std::string(thing) + (count == 1 ? "" : "s");
}

}  // namespace chladni::show
