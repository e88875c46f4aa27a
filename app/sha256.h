// The fingerprint that results carry of the study they came from.
#pragma once

#include <string>
#include <string_view>

namespace chladni::app {

/// 64 hexadecimal digits (FIPS 180-4).
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace chladni::app
