// The fingerprint that results carry of the study they came from.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace chladni::app {

/// 64 hexadecimal digits (FIPS 180-4).
[[nodiscard]] std::string sha256(std::string_view bytes);

/// The same of a file's bytes, which are read piece by piece.
/// @throws InvalidInput  it cannot be read
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace chladni::app
