#include "io/frf_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/frf_suspicions.h"
#include "io/gzip.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Path = std::filesystem::path;

enum class Format { csv, uff, mat, none };

// ".csv.gz" is ".csv": what is compressed shows in its first bytes.
Format format_of(const Path& file) {
  std::string ending = upper(file.extension().string());
  if (ending == ".GZ") ending = upper(file.stem().extension().string());
  if (ending == ".CSV") return Format::csv;
  if (ending == ".UFF" || ending == ".UNV" || ending == ".UF") return Format::uff;
  if (ending == ".MAT") return Format::mat;
  return Format::none;
}

[[noreturn]] void refuse_ending(const Path& file) {
  throw InvalidInput(file.string() + ": \"" + file.extension().string() +
                     "\" is no ending of measured data; expected .csv, .uff, .unv or .mat");
}

std::string content_of(const Path& file, std::size_t limit) {
  std::string bytes = read_whole(file, limit);
  if (!is_gzip(bytes)) return bytes;
  try {
    return unzipped(bytes, limit);
  } catch (const InvalidInput& e) {
    throw InvalidInput(file.string() + ": " + e.what());
  }
}

FrfFile parsed(const Path& file, const FrfOptions& options) {
  switch (format_of(file)) {
    case Format::csv:
      return parse_frf_csv(content_of(file, options.limit_bytes), file.string(), options);
    default:
      refuse_ending(file);
  }
}

// What a table without a head cannot say.
std::vector<std::string> lost_in_csv(const modal::FrfSet& set) {
  bool units = false;
  for (const auto& output : set.outputs) units = units || !output.unit.empty();
  for (const auto& input : set.inputs) units = units || !input.unit.empty();
  if (!units) return {};
  return {"CSV holds no units: say unit = \"" + set.outputs.front().unit + "\" on reading"};
}

}  // namespace

bool is_measured_file(const Path& file) { return format_of(file) != Format::none; }

FrfFile read_frf(const Path& file, const FrfOptions& options) {
  FrfFile result = parsed(file, options);
  for (auto& suspicion : suspicions(result.set, options.collocated)) {
    result.notes.push_back(std::move(suspicion));
  }
  return result;
}

std::vector<std::string> write_frf(const Path& file, const modal::FrfSet& set) {
  switch (format_of(file)) {
    case Format::csv:
      write_atomically(file, frf_csv(set));
      return lost_in_csv(set);
    default:
      refuse_ending(file);
  }
}

}  // namespace chladni::io
