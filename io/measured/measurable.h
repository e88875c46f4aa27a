// The limit of measured numbers.
#pragma once

#include <cmath>
#include <string>

namespace chladni::io {

/// The largest number in files of measured data, in any unit. Its square, also divided by a
/// variance of 1e-100, is finite in double precision.
inline constexpr double kLargestMeasured = 1e100;

/// Whether a number may come from a measurement. NaN is allowed: it means that there is no value.
[[nodiscard]] inline bool is_measurable(double number) {
  return std::isnan(number) || std::abs(number) <= kLargestMeasured;
}

/// A coherence of single precision, or of six digits, may be 1.000001 or −1e-7: then it is 1 or 0.
/// Others stay as they are.
[[nodiscard]] inline double rounded_coherence(double coherence) {
  constexpr double kRounding = 1e-5;
  if (coherence > 1.0 && coherence <= 1.0 + kRounding) return 1.0;
  return coherence < 0.0 && coherence >= -kRounding ? 0.0 : coherence;
}

/// A message for a refused number: "found 1e+200, expected a number below 1e+100 in size".
[[nodiscard]] std::string not_measurable(double number);

/// Whether a mode of a body may have this frequency [Hz]: 0, or 1e-6 to 1e12.
[[nodiscard]] inline bool is_frequency_of_mode(double hz) {
  return hz == 0.0 || (hz >= 1e-6 && hz <= 1e12);
}

/// A message for a refused frequency.
[[nodiscard]] std::string no_frequency_of_mode(double hz);

}  // namespace chladni::io
