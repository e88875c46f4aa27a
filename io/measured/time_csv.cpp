// Recordings as a table with one line per sample.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/error.h"
#include "io/bytes/csv_table.h"
#include "io/csv.h"
#include "io/measured/frf_units.h"
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

struct RecordLayout {
  Index time = -1, experiment = -1, realisation = -1, period = -1;
  std::array<std::vector<Index>, 3> columns;  // by Side
};

// The special column with this name; null: the column belongs to a channel.
Index* special(const std::string& name, RecordLayout& layout) {
  if (name == "time_s" || name == "time" || name == "t" || name == "t_s") return &layout.time;
  if (name == "experiment") return &layout.experiment;
  if (name == "realisation" || name == "realization") return &layout.realisation;
  if (name == "period") return &layout.period;
  return nullptr;
}

std::vector<modal::MeasuredChannel>& channels_of(recordings::TimeData& data, Side side) {
  return side == Side::output ? data.outputs : side == Side::input ? data.inputs : data.references;
}

std::string named(const std::vector<modal::MeasuredChannel>& channels) {
  const auto names = modal::names_of(channels);
  return names.empty() ? "none" : listed(names);
}

RecordLayout layout_of(const CsvTable& table, const TimeOptions& options, TimeFile& file) {
  RecordLayout layout;
  std::array<std::set<std::string>, 3> seen;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    Index* place = special(table.names[c], layout);
    if (place != nullptr) {
      require(*place < 0, table.file + ": two columns of the " + table.names[c]);
      *place = static_cast<Index>(c);
      continue;
    }
    const auto [side, name] = side_of(table.names[c], options);
    require(seen[static_cast<std::size_t>(side)].insert(name).second,
            table.file + ": two columns of the channel " + shown(name));
    layout.columns[static_cast<std::size_t>(side)].push_back(static_cast<Index>(c));
    channels_of(file.data, side).emplace_back().name = name;
  }
  require(!file.data.outputs.empty() || !file.data.inputs.empty(),
          table.file + ": there is no column of a channel");
  file.notes.push_back(
      "outputs: " + named(file.data.outputs) + "; inputs: " + named(file.data.inputs) +
      (file.data.references.empty() ? "" : "; references: " + named(file.data.references)));
  return layout;
}

[[noreturn]] void fail(const CsvTable& table, Index row, const std::string& what) {
  throw InvalidInput(table.file + ": line " +
                     fmt::to_string(table.line[static_cast<std::size_t>(row)]) + ": " + what);
}

int whole(const CsvTable& table, Index row, Index column) {
  if (column < 0) return 0;
  const double value = table.values(row, column);
  if (value >= 0.0 && value <= 1e6 && value == std::floor(value)) return static_cast<int>(value);
  fail(table, row,
       table.names[static_cast<std::size_t>(column)] + " is " + fmt::format("{:.6g}", value) +
           ", expected a whole number, 0 or more");
}

/// Rows [first, end) of one recording.
struct Stretch {
  Index first = 0, end = 0;
  int experiment = 0, realisation = 0;
};

std::vector<Stretch> stretches_of(const CsvTable& table, const RecordLayout& layout) {
  std::vector<Stretch> found;
  for (Index row = 0; row < table.values.rows(); ++row) {
    const int experiment = whole(table, row, layout.experiment);
    const int realisation = whole(table, row, layout.realisation);
    if (found.empty() || found.back().experiment != experiment ||
        found.back().realisation != realisation) {
      found.push_back({row, row, experiment, realisation});
    }
    found.back().end = row + 1;
  }
  return found;
}

// What is wrong with the time of a recording whose steps are not all alike: samples that are
// missing, or another sample rate. Empty: neither.
struct TimeFault {
  Index row = -1;
  std::string what;
};

TimeFault fault_of(const Eigen::VectorXd& time, Index first, Index end) {
  std::vector<double> steps;
  for (Index row = first + 1; row < end; ++row) steps.push_back(time(row) - time(row - 1));
  if (steps.empty()) return {};
  auto sorted = steps;
  std::ranges::nth_element(sorted, sorted.begin() + std::ssize(sorted) / 2);
  const double usual = sorted[sorted.size() / 2];
  if (!(usual > 0.0)) return {};
  const auto differs = [&](double step) { return std::abs(step - usual) > 0.1 * usual; };
  const auto odd = std::ranges::find_if(steps, differs);
  if (odd == steps.end()) return {};
  const Index row = first + 1 + (odd - steps.begin());
  const double ratio = *odd / usual;
  const bool stays = odd + 1 < steps.end() && std::abs(odd[1] - *odd) < 0.1 * std::abs(*odd);
  if (ratio > 1.5 && std::abs(ratio - std::round(ratio)) < 0.1 && !stays) {
    const double missing = std::round(ratio) - 1.0;
    return {row, fmt::format("{:.0f} sample{} missing before it", missing,
                             missing == 1.0 ? " is" : "s are")};
  }
  const auto changes = [&](Index at, double before, double after) {
    return TimeFault{at, fmt::format("the sample rate changes from {:.6g} to {:.6g} Hz",
                                     1.0 / before, 1.0 / after)};
  };
  if (odd != steps.begin()) return changes(row, *(odd - 1), *odd);
  const auto next = std::ranges::find_if_not(steps, differs);
  return changes(first + 1 + (next - steps.begin()), *odd, usual);
}

// The time step of the first recording. The other recordings must have the same step.
double sample_time(const CsvTable& table, const RecordLayout& layout,
                   const std::vector<Stretch>& stretches, const TimeOptions& options) {
  if (layout.time < 0) {
    require(options.sample_time_s > 0.0,
            table.file + ": there is no column time_s, and no sample time is stated");
    return options.sample_time_s;
  }
  const auto time = table.values.col(layout.time);
  for (Index row = 0; row < time.size(); ++row) {
    if (!std::isfinite(time(row))) {
      fail(table, row,
           table.names[static_cast<std::size_t>(layout.time)] + " is empty or no number");
    }
  }
  const auto& first = stretches.front();
  const Index steps = first.end - first.first - 1;
  require(steps > 0, table.file + ": one sample only, expected two or more");
  const double mean = (time(first.end - 1) - time(first.first)) / static_cast<double>(steps);
  const double step = time(first.first + 1) - time(first.first);
  const double result = std::abs(step - mean) < 1e-12 * std::abs(mean) ? step : mean;
  if (!(result > 0.0)) fail(table, first.end - 1, "the time does not ascend");
  for (const auto& stretch : stretches) {
    for (Index row = stretch.first; row < stretch.end; ++row) {
      const double expected =
          time(stretch.first) + result * static_cast<double>(row - stretch.first);
      if (std::abs(time(row) - expected) < 0.01 * result) continue;
      if (const auto fault = fault_of(time, stretch.first, stretch.end); fault.row >= 0) {
        fail(table, fault.row,
             table.names[static_cast<std::size_t>(layout.time)] + " is " +
                 fmt::format("{:.9g}: ", time(fault.row)) + fault.what +
                 "; expected one step from sample to sample");
      }
      fail(table, row,
           table.names[static_cast<std::size_t>(layout.time)] + " is " +
               fmt::format("{:.9g}", time(row)) + ", expected " + fmt::format("{:.9g}", expected) +
               ": one step from sample to sample");
    }
  }
  return result;
}

// The length of a run of equal numbers in the column `period`.
Index period_of(const CsvTable& table, const RecordLayout& layout,
                const std::vector<Stretch>& stretches, const TimeOptions& options) {
  if (options.period > 0 || layout.period < 0) return options.period;
  Index length = 0;
  for (const auto& stretch : stretches) {
    Index start = stretch.first;
    for (Index row = start + 1; row <= stretch.end; ++row) {
      const bool ends = row == stretch.end ||
                        whole(table, row, layout.period) != whole(table, start, layout.period);
      if (!ends) continue;
      if (length == 0) length = row - start;
      if (row - start != length) {
        fail(table, start,
             "a period of " + fmt::to_string(row - start) + " samples, others have " +
                 fmt::to_string(length));
      }
      start = row;
    }
  }
  return length;
}

Eigen::MatrixXd samples(const CsvTable& table, const Stretch& stretch,
                        const std::vector<Index>& columns) {
  Eigen::MatrixXd result(stretch.end - stretch.first, static_cast<Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto values =
        table.values.col(columns[c]).segment(stretch.first, stretch.end - stretch.first);
    for (Index row = 0; row < values.size(); ++row) {
      if (std::isfinite(values(row))) continue;
      fail(table, stretch.first + row,
           table.names[static_cast<std::size_t>(columns[c])] + " is empty, expected a number");
    }
    result.col(static_cast<Index>(c)) = values;
  }
  return result;
}

void state_units(TimeFile& file, const TimeOptions& options) {
  const auto unit = stated_unit(options.unit);
  for (auto& output : file.data.outputs) {
    output.unit = unit.si;
    output.kind = unit.kind.value_or(output.kind);
  }
  if (unit.kind) {
    for (auto& record : file.data.records) record.outputs *= unit.factor;
  } else if (options.unit.empty() && !file.data.outputs.empty()) {
    file.notes.emplace_back(
        "the units are not stated: values are as they stand; say that of the outputs as unit = "
        "\"m\", \"m/s^2\" or \"g\"");
  }
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
  file.data.period = period_of(table, layout, stretches, options);
  for (const auto& stretch : stretches) {
    file.data.records.push_back(
        {samples(table, stretch, layout.columns[0]), samples(table, stretch, layout.columns[1]),
         samples(table, stretch, layout.columns[2]), stretch.experiment, stretch.realisation});
  }
  state_units(file, options);
  return file;
}

namespace {

std::string column_name(const modal::MeasuredChannel& channel, Side side) {
  RecordLayout nothing;
  const auto is_read_back = [&](std::string word) {
    return special(word, nothing) == nullptr &&
           side_of(word, {}) == std::pair(side, channel.name) && trimmed(word) == word &&
           word.find_first_of("\r\n") == std::string_view::npos && !number_in(word) &&
           word.front() != '#';
  };
  if (is_read_back(channel.name)) return channel.name;
  std::string word = std::string(kSidePrefix[static_cast<std::size_t>(side)]) + channel.name;
  require(is_read_back(word), "CSV cannot hold the channel name " + shown(channel.name) +
                                  "; expected one without line ends and blanks around it");
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

}  // namespace

std::string time_csv(const recordings::TimeData& data) {
  Index rows = 0;
  for (const auto& record : data.records) rows += record.outputs.rows();
  Eigen::VectorXd time(rows);
  Eigen::VectorXi experiment(rows);
  Eigen::VectorXi realisation(rows);
  Eigen::VectorXi period(rows);
  Index at = 0;
  for (const auto& record : data.records) {
    for (Index n = 0; n < record.outputs.rows(); ++n, ++at) {
      time(at) = static_cast<double>(n) * data.sample_time_s;
      experiment(at) = record.experiment;
      realisation(at) = record.realisation;
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
