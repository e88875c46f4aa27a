// What is said of a forecast.
#include <fmt/format.h>

#include "stage/forecast.h"

namespace chladni::stage {

std::string bytes_text(double bytes) {
  if (bytes > 1e15) return "over 1000 TB";  // more than any computer has
  return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6)
                     : fmt::format("{:.1f} GB", bytes / 1e9);
}

namespace {

// "4 s", "5 h", "12 days".
std::string work_text(double seconds) {
  constexpr double kHour = 3600.0, kDay = 24.0 * kHour, kYear = 365.25 * kDay;
  if (seconds > 1e3 * kYear) return "more than a thousand years";
  if (seconds > 2.0 * kYear) return fmt::format("{:.0f} years", seconds / kYear);
  if (seconds > 2.0 * kDay) return fmt::format("{:.0f} days", seconds / kDay);
  if (seconds > 3.0 * kHour) return fmt::format("{:.0f} h", seconds / kHour);
  return fmt::format("{:.{}f} s", seconds, seconds < 9.5 ? 1 : 0);
}

}  // namespace

std::string Cost::line() const {
  const auto memory = bytes_text(memory_bytes);
  return fmt::format("forecast: {}{:.0f} degrees of freedom, {}{} of memory and {} of one core",
                     exact ? "" : "about ", degrees_of_freedom,
                     memory.starts_with("over") ? "" : "about ", memory, work_text(seconds));
}

std::vector<std::string> implausible(const Understood& body) {
  std::vector<std::string> warnings;
  const double longest = body.extent_m.maxCoeff();
  const auto unit_question = " long: is the length unit right?";
  if (longest > 10.0 * (1.0 + 1e-9)) {
    warnings.push_back(fmt::format("the body is {:.4g} m{}", longest, unit_question));
  }
  if (longest < 1e-3) {
    warnings.push_back(fmt::format("the body is {:.4g} mm{}", 1e3 * longest, unit_question));
  }
  const double hz = body.first_frequency_hz;
  if (hz < 1.0 || hz > 1e5) {
    warnings.push_back(
        fmt::format("its first flexible mode is estimated at {:.4g} Hz, outside 1 Hz "
                    "to 100 kHz: are the dimensions and the material right?",
                    hz));
  }
  return warnings;
}

}  // namespace chladni::stage
