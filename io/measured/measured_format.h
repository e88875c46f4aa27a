// Which format a file of measured data is in.
#pragma once

#include <filesystem>
#include <string>

namespace chladni::io {

enum class MeasuredFormat { csv, uff, mat, none };

/// By the ending: .csv, .uff .unv .uf, .mat, of text also with .gz behind it.
[[nodiscard]] MeasuredFormat measured_format(const std::filesystem::path& file);

/// The same of a file to be written. @throws InvalidInput  none of them, or compressed
[[nodiscard]] MeasuredFormat written_format(const std::filesystem::path& file);

/// @throws InvalidInput  says which endings there are
[[noreturn]] void refuse_ending(const std::filesystem::path& file);

/// The bytes of the file, unpacked where it is compressed by gzip.
/// @param limit  bytes of memory for what the file holds
/// @throws InvalidInput  it cannot be read, is damaged, or is larger than the limit allows
[[nodiscard]] std::string content_of(const std::filesystem::path& file, std::size_t limit);

}  // namespace chladni::io
