// Which Chladni this is.
#pragma once

#include <string>

namespace chladni::app {

/// The version with the commit that it was built from: "0.1.0+g0123456789", with "-dirty" where the
/// sources had changes that were not committed; "0.1.0+unknown-commit" where neither git nor the
/// archive knew (cmake/write_version.cmake).
[[nodiscard]] std::string version();

}  // namespace chladni::app
