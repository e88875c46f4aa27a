// Which files of recordings are read in pieces, and how.
#include <string>
#include <vector>

#include "base/interrupt.h"
#include "io/bytes/csv_table.h"
#include "io/bytes/gzip.h"
#include "io/matlab/time_mat.h"
#include "io/measured/measured_format.h"
#include "io/measured/time_columns.h"
#include "io/recordings_file.h"
#include "io/uff/time_uff.h"

namespace chladni::io {
namespace {

// Memory for a file that is read as a whole and estimated, over its size; of a universal file in
// single precision.
constexpr std::uintmax_t kWholeCost = 4, kWholeCostOfUff = 20;
constexpr std::size_t kHead = std::size_t{1} << 16U;  // of a universal file, with a function

std::string begin_of(const std::filesystem::path& file, std::size_t bytes) {
  std::string begin(bytes, '\0');
  begin.resize(UnpackedFile(file).read(begin.data(), bytes));
  return begin;
}

bool has_column_of_periods(const std::filesystem::path& file) {
  const CsvRows rows(file);
  RecordLayout layout;
  for (const auto& name : rows.head().names) {
    if (auto* column = special_column(name, name, layout)) *column = 0;
  }
  return layout.period >= 0;
}

// Whether a text is longer than this; a packed one is unpacked so far.
bool is_longer(const std::filesystem::path& file, std::uintmax_t bytes) {
  UnpackedFile content(file);
  if (!content.is_packed()) return std::filesystem::file_size(file) > bytes;
  std::vector<char> room(std::size_t{1} << 20U);
  std::uintmax_t length = 0;
  for (std::size_t count = room.size(); count == room.size() && length <= bytes; length += count) {
    throw_if_interrupted();
    count = content.read(room.data(), room.size());
  }
  return length > bytes;
}

}  // namespace

bool is_read_in_pieces(const std::filesystem::path& file, const TimeOptions& options) {
  const auto format = measured_format(file);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || error) return false;
  const bool in_any_case = options.period > 0 || options.blows_in_pieces;
  if (format == MeasuredFormat::uff) {
    return is_longer(file, options.limit_bytes / kWholeCostOfUff) &&
           (in_any_case || states_period(begin_of(file, kHead)));
  }
  if (format == MeasuredFormat::mat) return is_mat_read_in_pieces(file, options);
  return format == MeasuredFormat::csv && is_longer(file, options.limit_bytes / kWholeCost) &&
         (in_any_case || has_column_of_periods(file));
}

RecordingsFile read_in_pieces(const std::filesystem::path& file, const TimeOptions& options) {
  switch (measured_format(file)) {
    case MeasuredFormat::uff:
      return parse_time_uff_in_pieces(content_of(file, options.limit_bytes), file.string(),
                                      options);
    case MeasuredFormat::mat:
      return read_mat_in_pieces(file, options);
    default:
      return read_csv_in_pieces(file, options);
  }
}

}  // namespace chladni::io
