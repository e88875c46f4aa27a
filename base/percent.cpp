#include "base/percent.h"

#include <fmt/format.h>

#include <cmath>

namespace chladni {

std::string percent(double part) {
  return std::isfinite(part) ? fmt::format("{:.3g} %", 100.0 * part) : "-";
}

std::string percent_cell(double part) {
  return std::isfinite(part) ? fmt::format("{:.3g}", 100.0 * part) : "\u2013";
}

}  // namespace chladni
