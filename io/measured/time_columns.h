// The columns of a table of recordings, and what its rows say of time and periods.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "io/bytes/csv_table.h"
#include "io/time_file.h"

namespace chladni::io {

/// Columns of a table; −1: there is none.
struct RecordLayout {
  Eigen::Index time = -1, experiment = -1, realisation = -1, period = -1;
  std::array<std::vector<Eigen::Index>, 3> columns;  ///< of channels, by Side
  std::array<std::vector<double>, 3> factors;        ///< SI value of 1 in these columns
  double seconds = 1.0;                              ///< of 1 in the column of times
};

/// The special column with this name; null: the column belongs to a channel. @param head  the name
/// with its unit, "Time [ms]"
[[nodiscard]] Eigen::Index* special_column(const std::string& name, const std::string& head,
                                           RecordLayout& layout);

/// The columns of a table by their names. The channels and a note of them go to `file`. A channel
/// has the unit behind its name, "left [g]", else an output has that of `options`; where neither
/// states one that is noted.
/// @throws InvalidInput  two columns of one thing, none of a channel
[[nodiscard]] RecordLayout layout_of(const CsvTable& table, const TimeOptions& options,
                                     TimeFile& file);

/// Rows [first, end) of one recording.
struct Stretch {
  Eigen::Index first = 0, end = 0;
  int experiment = 0, realisation = 0;
};

/// @throws InvalidInput  an experiment or realisation that is no whole number
[[nodiscard]] std::vector<Stretch> stretches_of(const CsvTable& table, const RecordLayout& layout);

/// The times of one recording, in a table or on the disk.
struct RecordedTimes {
  std::string file, name;  ///< of the file and of the column
  Eigen::Index samples = 0;
  /// `count` times from `first` on; a few or 65 537 are asked for at once.
  std::function<Eigen::VectorXd(Eigen::Index first, Eigen::Index count)> times;
  std::function<int(Eigen::Index row)> line;  ///< line of the file
};
/// The name of the column of times; where it is in another unit, that its numbers are told in s.
[[nodiscard]] std::string time_name(const CsvTable& table, const RecordLayout& layout);
/// @param table  with a column of the time; it outlives the times
[[nodiscard]] RecordedTimes times_of(const CsvTable& table, const RecordLayout& layout,
                                     const Stretch& stretch);

/// The mean step of a recording; the first one where they agree. @throws InvalidInput  one sample,
/// a time that does not ascend
[[nodiscard]] double step_of(const RecordedTimes& time);
/// @throws InvalidInput  a row where the time is not that of this step: samples that are missing,
///                       another sample rate, another recording
void check_steps(const RecordedTimes& time, double step);
/// @throws InvalidInput  a time that is empty or no number
void check_times(const CsvTable& table, const RecordLayout& layout);

/// The whole number in a cell, at most a million; 0 where there is no such column.
/// @throws InvalidInput  none
[[nodiscard]] int whole_number(const CsvTable& table, Eigen::Index row, Eigen::Index column);

/// The lengths of runs of equal numbers in the column `period`, which must be one.
class PeriodRuns {
 public:
  /// Looks at the next rows of a recording.
  /// @throws InvalidInput  a run of another length, a cell that is no whole number
  void add(const CsvTable& table, Eigen::Index first, Eigen::Index end, Eigen::Index column);
  /// The recording ends. @throws InvalidInput  a run of another length
  void end();
  [[nodiscard]] Eigen::Index length() const { return length_; }  ///< 0: no rows

 private:
  std::string file_;
  Eigen::Index length_ = 0, run_ = 0;
  int number_ = 0, line_ = 0;  ///< of the run
};

/// The samples in SI where units are known. @throws InvalidInput  a sample is empty
[[nodiscard]] recordings::Record record_of(const CsvTable& table, const RecordLayout& layout,
                                           const Stretch& stretch);

/// "there is no column time_s, and no sample time is stated", behind the name of the file.
[[nodiscard]] std::string no_sample_time(const CsvTable& table);

}  // namespace chladni::io
