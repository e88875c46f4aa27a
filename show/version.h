// The version of Chladni.
#pragma once

#include <string>

namespace chladni::show {

/// The version with the commit of the build: "0.1.0+g0123456789", with "-dirty" if the sources had
/// uncommitted changes; "0.1.0+unknown-commit" if neither git nor the archive knew it
/// (cmake/write_version.cmake).
[[nodiscard]] std::string version();

}  // namespace chladni::show
