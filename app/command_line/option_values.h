// Numbers that options take with or without a unit.
#pragma once

#include <string>

namespace chladni::app {

/// Turns "8", "8 GB", "500 MB" or "1.5 TB" into the number of GB, as text that reads back to the
/// same bits. @return  what is wrong where it is not a size above 0; empty: nothing
[[nodiscard]] std::string in_gigabytes(std::string& text);

/// The same for a time, "0.001" or "1 ms", in seconds.
[[nodiscard]] std::string in_seconds(std::string& text);

}  // namespace chladni::app
