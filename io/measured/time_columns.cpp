#include "io/measured/time_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
std::vector<modal::MeasuredChannel>& channels_of(recordings::TimeData& data, Side side) {
  return side == Side::output ? data.outputs : side == Side::input ? data.inputs : data.references;
}

std::string named(const std::vector<modal::MeasuredChannel>& channels) {
  const auto names = modal::names_of(channels);
  return names.empty() ? "none" : listed(names);
}

[[noreturn]] void fail(const CsvTable& table, Index row, const std::string& what) {
  throw InvalidInput(table.file + ": line " +
                     fmt::to_string(table.line[static_cast<std::size_t>(row)]) + ": " + what);
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

}  // namespace

int whole_number(const CsvTable& table, Index row, Index column) {
  if (column < 0) return 0;
  const double value = table.values(row, column);
  if (value >= 0.0 && value <= 1e6 && value == std::floor(value)) return static_cast<int>(value);
  fail(table, row,
       table.names[static_cast<std::size_t>(column)] + " is " + fmt::format("{:.6g}", value) +
           ", expected a whole number, 0 or more");
}

Index* special_column(const std::string& name, RecordLayout& layout) {
  if (name == "time_s" || name == "time" || name == "t" || name == "t_s") return &layout.time;
  if (name == "experiment") return &layout.experiment;
  if (name == "realisation" || name == "realization") return &layout.realisation;
  if (name == "period") return &layout.period;
  return nullptr;
}

RecordLayout layout_of(const CsvTable& table, const TimeOptions& options, TimeFile& file) {
  RecordLayout layout;
  std::array<std::set<std::string>, 3> seen;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    Index* place = special_column(table.names[c], layout);
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

std::vector<Stretch> stretches_of(const CsvTable& table, const RecordLayout& layout) {
  std::vector<Stretch> found;
  for (Index row = 0; row < table.values.rows(); ++row) {
    const int experiment = whole_number(table, row, layout.experiment);
    const int realisation = whole_number(table, row, layout.realisation);
    if (found.empty() || found.back().experiment != experiment ||
        found.back().realisation != realisation) {
      found.push_back({row, row, experiment, realisation});
    }
    found.back().end = row + 1;
  }
  return found;
}

void check_times(const CsvTable& table, const RecordLayout& layout) {
  if (layout.time < 0) return;
  const auto time = table.values.col(layout.time);
  for (Index row = 0; row < time.size(); ++row) {
    if (!std::isfinite(time(row))) {
      fail(table, row,
           table.names[static_cast<std::size_t>(layout.time)] + " is empty or no number");
    }
  }
}

double step_of(const CsvTable& table, const RecordLayout& layout, const Stretch& stretch) {
  const auto time = table.values.col(layout.time);
  const Index steps = stretch.end - stretch.first - 1;
  require(steps > 0, table.file + ": one sample only, expected two or more");
  const double result =
      step_of(time(stretch.first), time(stretch.first + 1), time(stretch.end - 1), steps);
  if (!(result > 0.0)) fail(table, stretch.end - 1, "the time does not ascend");
  return result;
}

double step_of(double first, double second, double last, Index steps) {
  const double mean = (last - first) / static_cast<double>(steps);
  const double step = second - first;
  return std::abs(step - mean) < 1e-12 * std::abs(mean) ? step : mean;
}

bool is_on_step(double time, double expected, double step) {
  return std::abs(time - expected) < 0.01 * step;
}

void check_steps(const CsvTable& table, const RecordLayout& layout, const Stretch& stretch,
                 double step) {
  const auto time = table.values.col(layout.time);
  const auto& name = table.names[static_cast<std::size_t>(layout.time)];
  for (Index row = stretch.first; row < stretch.end; ++row) {
    const double expected = time(stretch.first) + step * static_cast<double>(row - stretch.first);
    if (is_on_step(time(row), expected, step)) continue;
    if (const auto fault = fault_of(time, stretch.first, stretch.end); fault.row >= 0) {
      fail(table, fault.row,
           name + " is " + fmt::format("{:.9g}: ", time(fault.row)) + fault.what +
               "; expected one step from sample to sample");
    }
    fail(table, row,
         fmt::format("{} is {:.9g}, expected {:.9g}: one step from sample to sample", name,
                     time(row), expected));
  }
}

void PeriodRuns::add(const CsvTable& table, Index first, Index end_row, Index column) {
  file_ = table.file;
  for (Index row = first; row < end_row; ++row) {
    const int number = whole_number(table, row, column);
    if (run_ > 0 && number != number_) end();
    if (run_++ > 0) continue;
    number_ = number;
    line_ = table.line[static_cast<std::size_t>(row)];
  }
}

void PeriodRuns::end() {
  if (run_ == 0) return;
  if (length_ == 0) length_ = run_;
  require(run_ == length_, file_ + ": line " + fmt::to_string(line_) + ": a period of " +
                               fmt::to_string(run_) + " samples, others have " +
                               fmt::to_string(length_));
  run_ = 0;
}

recordings::Record record_of(const CsvTable& table, const RecordLayout& layout,
                             const Stretch& stretch) {
  return {samples(table, stretch, layout.columns[0]), samples(table, stretch, layout.columns[1]),
          samples(table, stretch, layout.columns[2]), stretch.experiment, stretch.realisation};
}

double state_units(TimeFile& file, const TimeOptions& options) {
  const auto unit = stated_unit(options.unit);
  for (auto& output : file.data.outputs) {
    output.unit = unit.si;
    output.kind = unit.kind.value_or(output.kind);
  }
  if (!unit.kind && options.unit.empty() && !file.data.outputs.empty()) {
    file.notes.emplace_back(
        "the units are not stated: values are as they stand; say that of the outputs as unit = "
        "\"m\", \"m/s^2\" or \"g\"");
  }
  return unit.kind ? unit.factor : 1.0;
}

}  // namespace chladni::io
