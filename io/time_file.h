// Recordings, sample by sample, in files: CSV, universal files (UFF), MAT.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "identification/time_data.h"
#include "io/bytes/room.h"

namespace chladni::io {

/// What a file of recordings does not say itself.
struct TimeOptions {
  std::vector<std::string> sensor_names, actuator_names, reference_names;
  double sample_time_s = 0.0;  ///< where the file has no time; 0: not known
  Eigen::Index period = 0;     ///< [samples] of a periodic excitation; 0: as the file says
  std::string unit;            ///< of the outputs where the file has none: "mm", "g"
  std::size_t limit_bytes = reading_limit();  ///< of memory for what the file holds
};

struct TimeFile {
  std::string format;  ///< "CSV", "UFF 58", "MAT 5"
  identification::TimeData data;
  std::vector<std::string> notes;
};

/// By its ending, as read_frf. @throws as read_frf
[[nodiscard]] TimeFile read_time(const std::filesystem::path& file,
                                 const TimeOptions& options = {});

/// By its ending: .csv, .uff .unv, .mat (v5). @return what the format cannot hold
/// @throws InvalidInput  another ending, or a name that the format cannot hold
[[nodiscard]] std::vector<std::string> write_time(const std::filesystem::path& file,
                                                  const identification::TimeData& data);

/// The bytes of a CSV file: columns named after channels, and of `time_s`, `experiment`,
/// `realisation` and `period` (counted from 0) those there are. A name that no option knows is of
/// an input where it is u, f, a, force, input or hammer with or without digits, of a reference
/// where it is r, w or reference, else of an output; "in_", "out_" and "ref_" before it decide and
/// are left out.
[[nodiscard]] TimeFile parse_time_csv(std::string_view bytes, const std::string& name,
                                      const TimeOptions& options = {});

/// What parse_time_csv reads back to the last bit, units aside.
[[nodiscard]] std::string time_csv(const identification::TimeData& data);

enum class Side { output, input, reference };

/// On which side a channel of that name is, by the lists of `options`, else by the rule above.
/// The second entry is the name without what decides.
[[nodiscard]] std::pair<Side, std::string> side_of(std::string_view name,
                                                   const TimeOptions& options);

}  // namespace chladni::io
