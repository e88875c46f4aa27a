#include "io/measured/measured_format.h"

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/bytes/gzip.h"
#include "io/bytes/room.h"
#include "io/scan.h"

namespace chladni::io {

MeasuredFormat measured_format(const std::filesystem::path& file) {
  std::string ending = upper(file.extension().string());
  if (ending == ".GZ") ending = upper(file.stem().extension().string());
  if (ending == ".CSV") return MeasuredFormat::csv;
  if (ending == ".UFF" || ending == ".UNV" || ending == ".UF") return MeasuredFormat::uff;
  if (ending == ".MAT") return MeasuredFormat::mat;
  return MeasuredFormat::none;
}

MeasuredFormat written_format(const std::filesystem::path& file) {
  const auto format = measured_format(file);
  if (format == MeasuredFormat::none || upper(file.extension().string()) == ".GZ") {
    refuse_ending(file);
  }
  return format;
}

void refuse_ending(const std::filesystem::path& file) {
  throw InvalidInput(file.string() + ": \"" + file.extension().string() +
                     "\" is no ending of measured data; expected .csv, .uff, .unv or .mat");
}

std::string content_of(const std::filesystem::path& file, std::size_t limit) {
  std::string bytes = read_whole(file, limit);
  if (!is_gzip(bytes)) return bytes;
  try {
    return unzipped(bytes, text_limit(limit));
  } catch (const InvalidInput& e) {
    throw InvalidInput(file.string() + ": " + e.what());
  }
}

}  // namespace chladni::io
