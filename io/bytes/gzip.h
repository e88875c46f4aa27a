// Compressed files.
#pragma once

#include <string>
#include <string_view>

namespace chladni::io {

/// Whether these bytes begin as a gzip file.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// What was compressed, of one gzip file or several one after the other.
/// @throws InvalidInput  it is damaged, cut off or larger than `limit` bytes
[[nodiscard]] std::string unzipped(std::string_view bytes, std::size_t limit);

}  // namespace chladni::io
