// The format of a file of measured data.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::io {

enum class MeasuredFormat { csv, uff, mat, none };

/// The format by the ending: .csv, .uff .unv .uf, .mat. Text files may have .gz after it.
[[nodiscard]] MeasuredFormat measured_format(const std::filesystem::path& file);

/// The format of a file to be written. @throws InvalidInput  another ending, or a compressed file
[[nodiscard]] MeasuredFormat written_format(const std::filesystem::path& file);

/// @throws InvalidInput  always; lists the possible endings
[[noreturn]] void refuse_ending(const std::filesystem::path& file);

/// What the function of the format of a file to be written returns; all three return the same type.
/// @throws InvalidInput  as written_format, another ending; what the function throws
template <typename Csv, typename Uff, typename Mat>
auto in_written_format(const std::filesystem::path& file, const Csv& csv, const Uff& uff,
                       const Mat& mat) {
  switch (written_format(file)) {
    case MeasuredFormat::csv:
      return csv();
    case MeasuredFormat::uff:
      return uff();
    case MeasuredFormat::mat:
      return mat();
    default:
      refuse_ending(file);
  }
}

/// The bytes of the file, unpacked if it is compressed by gzip.
/// @param limit  bytes of memory for the content of the file
/// @throws InvalidInput  the file cannot be read, is damaged, or is larger than the limit allows
[[nodiscard]] std::string content_of(const std::filesystem::path& file, std::size_t limit);

/// What of channels a CSV table cannot hold, in sentences.
/// @param sides  the outputs first
[[nodiscard]] std::vector<std::string> lost_in_csv(
    const std::vector<const std::vector<modal::MeasuredChannel>*>& sides);

}  // namespace chladni::io
