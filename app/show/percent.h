// Parts of a hundred as people read them.
#pragma once

#include <string>

namespace chladni::app {

/// "12.3 %", or "-" where it is not finite.
[[nodiscard]] std::string percent(double part);
/// "12.3" for a column that says %, or a dash.
[[nodiscard]] std::string percent_cell(double part);

}  // namespace chladni::app
