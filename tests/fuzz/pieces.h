// A CSV of recordings, read as a whole and in pieces: both are refused or both say the same.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/measured/measured_format.h"
#include "io/recordings_file.h"
#include "tests/fuzz/measured.h"

namespace chladni::io {

struct TwoReadings {
  std::optional<TimeFile> whole;         ///< nothing: refused
  std::optional<RecordingsFile> pieces;  ///< nothing: refused
};

/// A file in memory that goes with this.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : file_(memfd_create("chladni", MFD_CLOEXEC)) {
    require(file_ >= 0 && write(file_, bytes.data(), bytes.size()) == std::ssize(bytes),
            "a file in memory cannot be written");
  }
  ~MemoryFile() { close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  MemoryFile(MemoryFile&&) = delete;
  MemoryFile& operator=(MemoryFile&&) = delete;

  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

template <typename Read>
auto unless_refused(const Read& read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

inline TwoReadings read_time_pieces(std::string_view bytes) {
  TimeOptions options;
  options.sample_time_s = 0.1;
  const MemoryFile file(bytes);
  return {unless_refused([&] {
            const auto content = content_of(file.path(), options.limit_bytes);  // gzip or not
            return parse_time_csv(content, "f.csv", options);
          }),
          unless_refused([&] { return read_csv_in_pieces(file.path(), options); })};
}

[[nodiscard]] inline bool are_same(const recordings::Recordings& pieces, std::size_t record,
                                   recordings::Side side, const Eigen::MatrixXd& expected) {
  for (Eigen::Index c = 0; c < expected.cols(); ++c) {
    if (pieces.samples(record, side, c, 0, expected.rows()) != expected.col(c)) return false;
  }
  return true;
}

[[nodiscard]] inline bool are_same(const TimeFile& whole, const RecordingsFile& read) {
  using recordings::Side;
  const auto& pieces = read.data;
  const auto& data = whole.data;
  if (read.notes != whole.notes || pieces.head.sample_time_s != data.sample_time_s ||
      pieces.head.period != data.period || pieces.records.size() != data.records.size() ||
      pieces.head.outputs.size() != data.outputs.size() ||
      pieces.head.inputs.size() != data.inputs.size() ||
      pieces.head.references.size() != data.references.size()) {
    return false;
  }
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const auto& record = data.records[r];
    const auto& place = pieces.records[r];
    if (place.samples != record.outputs.rows() || place.experiment != record.experiment ||
        place.realisation != record.realisation ||
        !are_same(pieces, r, Side::outputs, record.outputs) ||
        !are_same(pieces, r, Side::inputs, record.inputs) ||
        !are_same(pieces, r, Side::references, record.references)) {
      return false;
    }
  }
  return true;
}

/// @throws InvalidInput  both refuse the file
[[nodiscard]] inline bool is_sound(const TwoReadings& readings) {
  if (readings.whole.has_value() != readings.pieces.has_value()) return false;
  require(readings.whole.has_value(), "refused by both");
  return is_sound(*readings.whole) && are_same(*readings.whole, *readings.pieces);
}

}  // namespace chladni::io
