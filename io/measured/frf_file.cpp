#include "io/frf_file.h"

#include "host/atomic_file.h"
#include "io/matlab/frf_mat.h"
#include "io/measured/frf_suspicions.h"
#include "io/measured/measured_format.h"
#include "io/uff/frf_uff.h"

namespace chladni::io {
namespace {

using Path = std::filesystem::path;

FrfFile parsed(const Path& file, const FrfOptions& options) {
  switch (measured_format(file)) {
    case MeasuredFormat::csv:
      return parse_frf_csv(content_of(file, options.limit_bytes), file.string(), options);
    case MeasuredFormat::uff:
      return parse_frf_uff(content_of(file, options.limit_bytes), file.string(), options);
    case MeasuredFormat::mat:
      return frf_of_mat(read_mat(file, mat_limit(options.limit_bytes)), file.string(), options);
    default:
      refuse_ending(file);
  }
}

}  // namespace

bool is_measured_file(const Path& file) { return measured_format(file) != MeasuredFormat::none; }

FrfFile read_frf(const Path& file, const FrfOptions& options) {
  FrfFile result = parsed(file, options);
  for (auto& suspicion : suspicions(result.set, options.collocated)) {
    result.notes.push_back(std::move(suspicion));
  }
  return result;
}

std::vector<std::string> write_frf(const Path& file, const modal::FrfSet& set, MatVersion version) {
  using Lost = std::vector<std::string>;
  const auto csv = [&] {
    write_atomically(file, frf_csv(set));
    return lost_in_csv({&set.outputs, &set.inputs});
  };
  const auto uff = [&] {
    Lost lost;
    write_atomically(file, frf_uff(set, UffEncoding::binary, lost));
    return lost;
  };
  const auto mat = [&] {
    write_mat(file, mat_of_frf(set), version);
    return Lost{};
  };
  return in_written_format(file, csv, uff, mat);
}

}  // namespace chladni::io
