#include "io/time_file.h"

#include "host/atomic_file.h"
#include "io/matlab/time_mat.h"
#include "io/measured/measured_format.h"
#include "io/uff/time_uff.h"

namespace chladni::io {

TimeFile read_time(const std::filesystem::path& file, const TimeOptions& options) {
  switch (measured_format(file)) {
    case MeasuredFormat::csv:
      return parse_time_csv(content_of(file, options.limit_bytes), file.string(), options);
    case MeasuredFormat::uff:
      return parse_time_uff(content_of(file, options.limit_bytes), file.string(), options);
    case MeasuredFormat::mat:
      return time_of_mat(read_mat(file, mat_limit(options.limit_bytes)), file.string(), options);
    default:
      refuse_ending(file);
  }
}

std::vector<std::string> write_time(const std::filesystem::path& file,
                                    const recordings::TimeData& data, MatVersion version) {
  using Lost = std::vector<std::string>;
  const auto csv = [&] {
    write_atomically(file, time_csv(data));
    return lost_in_csv({&data.outputs, &data.inputs, &data.references});
  };
  const auto uff = [&] {
    Lost lost;
    write_atomically(file, time_uff(data, UffEncoding::binary, lost));
    return lost;
  };
  const auto mat = [&] {
    write_mat(file, mat_of_time(data), version);
    return Lost{};
  };
  return in_written_format(file, csv, uff, mat);
}

}  // namespace chladni::io
