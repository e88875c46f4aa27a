// Recordings as a table with one line per sample.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "base/error.h"
#include "io/bytes/csv_table.h"
#include "io/csv.h"
#include "io/measured/column_head.h"
#include "io/measured/time_columns.h"
#include "io/measured_units.h"
#include "io/scan.h"
#include "io/time_file.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
constexpr double kBytesPerRecord = 320.0;  // three matrices and the allocator's overhead
constexpr std::array<std::string_view, 3> kSidePrefix{"out_", "in_", "ref_"};  // by Side

bool has_name(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

double sample_time(const CsvTable& table, const RecordLayout& layout,
                   const std::vector<Stretch>& stretches, const TimeOptions& options) {
  if (layout.time < 0) {
    require(options.sample_time_s > 0.0, no_sample_time(table));
    return options.sample_time_s;
  }
  check_times(table, layout);
  const double step = step_of(times_of(table, layout, stretches.front()));
  for (const auto& stretch : stretches) check_steps(times_of(table, layout, stretch), step);
  return step;
}

}  // namespace

namespace {

// The side by the letters of a name; digits after the letters do not count.
Side side_of_letters(std::string_view name) {
  std::string letters = upper(name);
  while (!letters.empty() && letters.back() >= '0' && letters.back() <= '9') letters.pop_back();
  while (letters.ends_with('_')) letters.pop_back();
  static const std::set<std::string> inputs{"U", "F", "A", "FORCE", "INPUT", "HAMMER"};
  static const std::set<std::string> references{"R", "W", "REFERENCE"};
  if (inputs.contains(letters)) return Side::input;
  return references.contains(letters) ? Side::reference : Side::output;
}

}  // namespace

std::pair<Side, std::string> side_of(std::string_view name, const TimeOptions& options) {
  const std::string whole_name(name);
  if (has_name(options.sensor_names, name)) return {Side::output, whole_name};
  if (has_name(options.actuator_names, name)) return {Side::input, whole_name};
  if (has_name(options.reference_names, name)) return {Side::reference, whole_name};
  for (std::size_t s = 0; s < kSidePrefix.size(); ++s) {
    if (name.size() > kSidePrefix[s].size() && name.starts_with(kSidePrefix[s])) {
      return {static_cast<Side>(s), whole_name.substr(kSidePrefix[s].size())};
    }
  }
  return {side_of_letters(name), whole_name};
}

std::pair<Side, std::string> side_of(std::string_view name, const std::string& unit,
                                     const TimeOptions& options) {
  auto found = side_of(name, options);
  const bool is_listed = has_name(options.sensor_names, found.second) ||
                         has_name(options.actuator_names, found.second) ||
                         has_name(options.reference_names, found.second);
  if (is_listed || found.second != name) return found;
  if (found.first == Side::output && force_unit(unit)) found.first = Side::input;
  if (found.first == Side::input && motion_unit(unit)) found.first = Side::output;
  return found;
}

TimeFile parse_time_csv(std::string_view bytes, const std::string& name,
                        const TimeOptions& options) {
  const CsvTable table = csv_table(bytes, name, options.limit_bytes);
  require(table.values.rows() > 0, name + ": no line of numbers below the names");
  TimeFile file{.format = "CSV", .data = {}, .notes = {}};
  const RecordLayout layout = layout_of(table, options, file);
  const auto stretches = stretches_of(table, layout);
  require_room(kBytesPerRecord * static_cast<double>(stretches.size()) +
                   8.0 * static_cast<double>(table.values.size()),
               options.limit_bytes, name + ": " + fmt::to_string(stretches.size()) + " recordings");
  file.data.sample_time_s = sample_time(table, layout, stretches, options);
  file.data.period = options.period;
  if (options.period == 0 && layout.period >= 0) {
    PeriodRuns runs;
    for (const auto& stretch : stretches) {
      runs.add(table, stretch.first, stretch.end, layout.period);
      runs.end();
    }
    file.data.period = runs.length();
  }
  for (const auto& stretch : stretches) {
    file.data.records.push_back(record_of(table, layout, stretch));
  }
  return file;
}

namespace {

std::string column_name(const modal::MeasuredChannel& channel, Side side) {
  RecordLayout nothing;
  const auto is_read_back = [&](std::string word) {
    return special_column(word, word, nothing) == nullptr &&
           channel_and_unit(word).second.empty() &&
           side_of(word, {}) == std::pair(side, channel.name) && trimmed(word) == word &&
           word.find_first_of("\r\n") == std::string_view::npos && !number_in(word) &&
           word.front() != '#';
  };
  if (is_read_back(channel.name)) return channel.name;
  std::string word = std::string(kSidePrefix[static_cast<std::size_t>(side)]) + channel.name;
  require(is_read_back(word), "CSV cannot hold the channel name " + shown(channel.name) +
                                  "; expected one without line ends, blanks around it and a unit");
  return word;
}

void add_columns(const recordings::TimeData& data, Side side,
                 const std::vector<modal::MeasuredChannel>& channels,
                 Eigen::MatrixXd recordings::Record::*of, Index rows,
                 std::vector<CsvColumn>& columns) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Eigen::VectorXd entries(rows);
    Index at = 0;
    for (const auto& record : data.records) {
      entries.segment(at, record.outputs.rows()) = (record.*of).col(static_cast<Index>(c));
      at += record.outputs.rows();
    }
    columns.push_back({column_name(channels[c], side), std::move(entries)});
  }
}

bool runs_together(const recordings::Record& one, const recordings::Record& next) {
  return one.experiment == next.experiment && one.realisation == next.realisation;
}

// The realisations under which records are told apart: in a table a record ends where its numbers
// do. Blows may have any numbers, and are counted where theirs do not tell them apart.
std::vector<int> told_apart(const recordings::TimeData& data) {
  const auto& records = data.records;
  std::vector<int> numbers;
  for (const auto& record : records) numbers.push_back(record.realisation);
  const auto same = std::ranges::adjacent_find(records, runs_together);
  if (same == records.end()) return numbers;
  require(data.period == 0,
          fmt::format("CSV cannot hold two neighbouring recordings of experiment {} and "
                      "realisation {}; expected numbers that differ",
                      same->experiment, same->realisation));
  std::map<int, int> count;
  for (std::size_t r = 0; r < records.size(); ++r) numbers[r] = count[records[r].experiment]++;
  return numbers;
}

}  // namespace

std::string time_csv(const recordings::TimeData& data) {
  const auto realisations = told_apart(data);
  Index rows = 0;
  for (const auto& record : data.records) rows += record.outputs.rows();
  Eigen::VectorXd time(rows);
  Eigen::VectorXi experiment(rows);
  Eigen::VectorXi realisation(rows);
  Eigen::VectorXi period(rows);
  Index at = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const auto& record = data.records[r];
    for (Index n = 0; n < record.outputs.rows(); ++n, ++at) {
      time(at) = static_cast<double>(n) * data.sample_time_s;
      experiment(at) = record.experiment;
      realisation(at) = realisations[r];
      period(at) = data.period > 0 ? static_cast<int>(n / data.period) : 0;
    }
  }
  std::vector<CsvColumn> columns{{"time_s", time}};
  if (data.records.size() > 1 || experiment.any() || realisation.any()) {
    columns.push_back({"experiment", experiment});
    columns.push_back({"realisation", realisation});
  }
  if (data.period > 0) columns.push_back({"period", period});
  using recordings::Record;
  add_columns(data, Side::output, data.outputs, &Record::outputs, rows, columns);
  add_columns(data, Side::input, data.inputs, &Record::inputs, rows, columns);
  add_columns(data, Side::reference, data.references, &Record::references, rows, columns);
  return csv(columns);
}

}  // namespace chladni::io
