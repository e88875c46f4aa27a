// Recordings (samples over time) in files: CSV, universal files (UFF), MAT.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/room.h"
#include "recordings/time_data.h"

namespace chladni::io {

enum class MatVersion;  // io/mat.h

/// Information that a file of recordings does not contain.
struct TimeOptions {
  std::vector<std::string> sensor_names, actuator_names, reference_names;
  double sample_time_s = 0.0;  ///< used where the file has no time; 0: not known
  Eigen::Index period = 0;     ///< [samples] of a periodic excitation; 0: as in the file
  std::string unit;            ///< of the outputs where the file states none: "mm", "g", kEachInSi
  std::size_t limit_bytes = reading_limit();  ///< of memory for what the file holds
  bool blows_in_pieces = false;               ///< what has no period is read in pieces too
};

struct TimeFile {
  std::string format;  ///< "CSV", "UFF 58", "MAT 5"
  recordings::TimeData data;
  std::vector<std::string> notes;
};

/// Reads a file by its ending, as read_frf. @throws as read_frf
[[nodiscard]] TimeFile read_time(const std::filesystem::path& file,
                                 const TimeOptions& options = {});

/// Writes a file by its ending: .csv, .uff .unv, .mat. @return what the format cannot hold
/// @param version  of a .mat
/// @throws InvalidInput  another ending, or a name that the format cannot hold
[[nodiscard]] std::vector<std::string> write_time(const std::filesystem::path& file,
                                                  const recordings::TimeData& data,
                                                  MatVersion version = {});

/// Reads the bytes of a CSV file. Its columns are named after channels; columns `time_s`,
/// `experiment`, `realisation` and `period` (counted from 0) are optional. A name in a list of the
/// options has the side of this list. Else the prefix "in_", "out_" or "ref_" states the side and
/// is removed. Else the name is an input if it is u, f, a, force, input or hammer, a reference if
/// it is r, w or reference (each with or without digits), and otherwise an output. A unit in
/// brackets behind a name is that of the column, "Time [ms]", "left [g]"; a force is an input, a
/// motion such as "a1 [g]" none.
[[nodiscard]] TimeFile parse_time_csv(std::string_view bytes, const std::string& name,
                                      const TimeOptions& options = {});

/// A CSV text that parse_time_csv reads back to the last bit, except for units. Blows of one
/// experiment are counted.
/// @throws InvalidInput  neighbouring periodic records of one experiment and realisation; a name
///                       that a table cannot hold, such as one that ends in a unit
[[nodiscard]] std::string time_csv(const recordings::TimeData& data);

enum class Side { output, input, reference };

/// The side of a channel with that name, by the lists of `options`, else by the rule above. The
/// second entry is the name without a prefix.
[[nodiscard]] std::pair<Side, std::string> side_of(std::string_view name,
                                                   const TimeOptions& options);

/// As that, where the unit of the channel is known: what neither a list nor a prefix gives a side
/// is an input in a unit of force, and an output in a unit of motion.
[[nodiscard]] std::pair<Side, std::string> side_of(std::string_view name, const std::string& unit,
                                                   const TimeOptions& options);

}  // namespace chladni::io
