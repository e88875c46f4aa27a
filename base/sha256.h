// Fingerprints of bytes: of the study in its results, of the scripts that the report allows.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace chladni {

/// 64 hexadecimal digits (FIPS 180-4).
[[nodiscard]] std::string sha256(std::string_view bytes);

/// The same for the bytes of a file, read in pieces.
/// @throws InvalidInput  it cannot be read
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace chladni
