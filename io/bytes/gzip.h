// Compressed files.
#pragma once

#include <string>
#include <string_view>

namespace chladni::io {

/// Whether the bytes begin like a gzip file.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// The unpacked content of one gzip file, or of several gzip files one after the other.
/// @throws InvalidInput  the file is damaged or truncated, or its content exceeds `limit` bytes
[[nodiscard]] std::string unzipped(std::string_view bytes, std::size_t limit);

}  // namespace chladni::io
