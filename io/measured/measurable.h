// What no instrument gives.
#pragma once

#include <cmath>
#include <string>

namespace chladni::io {

/// The largest number in files of measured data, in any unit: its square, and that over a variance
/// of 1e-100, is finite in double precision.
inline constexpr double kLargestMeasured = 1e100;

/// Whether a number may come from a measurement; NaN may: it says that there is none.
[[nodiscard]] inline bool is_measurable(double number) {
  return std::isnan(number) || std::abs(number) <= kLargestMeasured;
}

/// Why a number is refused, for a message: "found 1e+200, expected a number below 1e+100 in size".
[[nodiscard]] std::string not_measurable(double number);

}  // namespace chladni::io
