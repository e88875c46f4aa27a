// Fractions as percentages.
#pragma once

#include <string>

namespace chladni {

/// "12.3 %", or "-" if it is not finite.
[[nodiscard]] std::string percent(double part);
/// "12.3" for a column in %, or a dash.
[[nodiscard]] std::string percent_cell(double part);

}  // namespace chladni
