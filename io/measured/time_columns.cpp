#include "io/measured/time_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/upper_median.h"
#include "io/measured/column_head.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
constexpr double kMostNumber = 1e6;  // of an experiment, a realisation, a period

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
// missing, another sample rate, another recording. No row: none of these.
struct TimeFault {
  Index row = -1;
  std::string what;
};

constexpr Index kPiece = 65536;  // times that are looked at at once
constexpr const char* kOneStep = "; expected one step from sample to sample";

// The first row from `from` on, 1 or more, that comes by such a step; −1: there is none.
template <typename Is>
Index first_step(const RecordedTimes& time, Index from, Is is) {
  for (Index row = from; row < time.samples; row += kPiece) {
    const auto some = time.times(row - 1, std::min(kPiece, time.samples - row) + 1);
    for (Index i = 1; i < some.size(); ++i) {
      if (is(some(i) - some(i - 1))) return row + i - 1;
    }
  }
  return -1;
}

// The step by which a row comes, 1 or more.
double step_at(const RecordedTimes& time, Index row) {
  const auto two = time.times(row - 1, 2);
  return two(1) - two(0);
}

// @param usual  step of the recording
TimeFault fall_of(const RecordedTimes& time, Index row, double usual) {
  const double begin = time.times(0, 1)(0);
  const double now = time.times(row, 1)(0);
  const bool is_another = step_at(time, row) < 0.0 && row > 1 && now <= begin + usual;
  if (!is_another) return {row, std::string("the time does not ascend") + kOneStep};
  return {row, "the time begins anew; give each recording its own experiment or realisation"};
}

// A step that differs from the usual one.
TimeFault odd_step(const RecordedTimes& time, Index row, double usual) {
  const double step = step_at(time, row);
  const double ratio = step / usual;
  const bool stays = row + 1 < time.samples && std::abs(step_at(time, row + 1) - step) < 0.1 * step;
  if (ratio > 1.5 && std::abs(ratio - std::round(ratio)) < 0.1 && !stays) {
    const double missing = std::round(ratio) - 1.0;
    return {row, fmt::format("{:.0f} sample{} missing before it{}", missing,
                             missing == 1.0 ? " is" : "s are", kOneStep)};
  }
  const auto changes = [&](Index at, double before, double after) {
    return TimeFault{at, fmt::format("the sample rate changes from {:.6g} to {:.6g} Hz{}",
                                     1.0 / before, 1.0 / after, kOneStep)};
  };
  if (row > 1) return changes(row, step_at(time, row - 1), step);
  const Index next =
      first_step(time, 2, [&](double other) { return std::abs(other - usual) <= 0.1 * usual; });
  return next < 0 ? TimeFault{} : changes(next, step, usual);
}

// The usual step is the median of the first ones.
TimeFault fault_of(const RecordedTimes& time) {
  const auto begin = time.times(0, std::min(kPiece, time.samples));
  if (begin.size() < 2) return {};
  Eigen::VectorXd steps = begin.tail(begin.size() - 1) - begin.head(begin.size() - 1);
  const double usual = upper_median(steps);
  const Index row = first_step(time, 1, [&](double step) {
    return !(step > 0.0) || (usual > 0.0 && std::abs(step - usual) > 0.1 * usual);
  });
  if (row < 0) return {};
  return step_at(time, row) > 0.0 ? odd_step(time, row, usual) : fall_of(time, row, usual);
}

[[noreturn]] void fail(const RecordedTimes& time, Index row, const std::string& what) {
  throw InvalidInput(time.file + ": line " + fmt::to_string(time.line(row)) + ": " + what);
}

void tell_fault(const RecordedTimes& time) {
  const auto fault = fault_of(time);
  if (fault.row < 0) return;
  fail(time, fault.row,
       fmt::format("{} is {:.9g}: ", time.name, time.times(fault.row, 1)(0)) + fault.what);
}

Eigen::MatrixXd samples(const CsvTable& table, const Stretch& stretch,
                        const std::vector<Index>& columns, const std::vector<double>& factors) {
  Eigen::MatrixXd result(stretch.end - stretch.first, static_cast<Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto values =
        table.values.col(columns[c]).segment(stretch.first, stretch.end - stretch.first);
    for (Index row = 0; row < values.size(); ++row) {
      if (std::isfinite(values(row))) continue;
      fail(table, stretch.first + row,
           table.names[static_cast<std::size_t>(columns[c])] + " is empty, expected a number");
    }
    result.col(static_cast<Index>(c)) = factors[c] * values;
  }
  return result;
}

/// What the name of a column says.
struct ChannelHead {
  Side side = Side::output;
  std::string name, unit;
};

// A name of the study may have brackets of its own.
ChannelHead channel_head(const CsvTable& table, std::size_t number, const TimeOptions& options) {
  const auto& column = table.names[number];
  const auto [whole, unit] = channel_and_unit(table, number);
  for (const auto* names :
       {&options.sensor_names, &options.actuator_names, &options.reference_names}) {
    if (std::ranges::find(*names, column) == names->end()) continue;
    return {side_of(column, options).first, column, table.units.empty() ? "" : unit};
  }
  const auto [side, name] = side_of(whole, unit, options);
  return {side, name, unit};
}

// Gives a channel the unit of its column. @return the SI value of 1
double take_unit(const ChannelHead& head, modal::MeasuredChannel& channel) {
  channel.unit = head.unit;
  if (const auto force = force_unit(head.unit)) {
    channel.unit = "N";
    return *force;
  }
  const auto motion = motion_unit(head.unit);
  if (!motion) return 1.0;
  channel.unit = motion->si;
  channel.kind = motion->kind.value_or(channel.kind);
  return motion->factor;
}

// States the units of the outputs that have none, and notes where they are not known.
void state_outputs(const TimeOptions& options, RecordLayout& layout, TimeFile& file) {
  note_unused(options.unit, file.data.outputs, file.notes);
  const auto unit = stated_unit(options.unit);
  bool is_missing = false;
  for (std::size_t c = 0; c < file.data.outputs.size(); ++c) {
    auto& output = file.data.outputs[c];
    if (!output.unit.empty()) continue;
    is_missing = true;
    output.unit = unit.si;
    output.kind = unit.kind.value_or(output.kind);
    if (unit.kind) layout.factors[0][c] = unit.factor;
  }
  if (!is_missing || unit.kind || !options.unit.empty()) return;
  file.notes.emplace_back(
      "the units are not stated: values are as they stand; say that of the outputs as unit = "
      "\"m\", \"m/s^2\" or \"g\"");
}

}  // namespace

int whole_number(const CsvTable& table, Index row, Index column) {
  if (column < 0) return 0;
  const double value = table.values(row, column);
  if (value >= 0.0 && value <= kMostNumber && value == std::floor(value)) {
    return static_cast<int>(value);
  }
  fail(table, row,
       fmt::format("{} is {}, expected a whole number from 0 to {:.0f}",
                   table.names[static_cast<std::size_t>(column)], value, kMostNumber));
}

Index* special_column(const std::string& name, const std::string& head, RecordLayout& layout) {
  if (const auto seconds = seconds_of_column(head)) {
    layout.seconds = *seconds;
    return &layout.time;
  }
  if (name == "experiment") return &layout.experiment;
  if (name == "realisation" || name == "realization") return &layout.realisation;
  if (name == "period") return &layout.period;
  return nullptr;
}

RecordLayout layout_of(const CsvTable& table, const TimeOptions& options, TimeFile& file) {
  RecordLayout layout;
  std::array<std::set<std::string>, 3> seen;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    Index* place = special_column(table.names[c], whole_head(table, c), layout);
    if (place != nullptr) {
      require(*place < 0, table.file + ": two columns of the " + table.names[c]);
      *place = static_cast<Index>(c);
      continue;
    }
    const auto head = channel_head(table, c, options);
    const auto s = static_cast<std::size_t>(head.side);
    require(seen[s].insert(head.name).second,
            table.file + ": two columns of the channel " + shown(head.name));
    layout.columns[s].push_back(static_cast<Index>(c));
    auto& channel = channels_of(file.data, head.side).emplace_back();
    channel.name = head.name;
    layout.factors[s].push_back(take_unit(head, channel));
  }
  require(!file.data.outputs.empty() || !file.data.inputs.empty(),
          table.file + ": there is no column of a channel");
  file.notes.push_back(
      "outputs: " + named(file.data.outputs) + "; inputs: " + named(file.data.inputs) +
      (file.data.references.empty() ? "" : "; references: " + named(file.data.references)));
  state_outputs(options, layout, file);
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

std::string time_name(const CsvTable& table, const RecordLayout& layout) {
  return table.names[static_cast<std::size_t>(layout.time)] +
         (layout.seconds == 1.0 ? "" : " in s");
}

RecordedTimes times_of(const CsvTable& table, const RecordLayout& layout, const Stretch& stretch) {
  return {.file = table.file,
          .name = time_name(table, layout),
          .samples = stretch.end - stretch.first,
          .times = [&table, column = layout.time, seconds = layout.seconds, before = stretch.first](
                       Index first, Index count) -> Eigen::VectorXd {
            return seconds * table.values.col(column).segment(before + first, count);
          },
          .line = [&table, before = stretch.first](
                      Index row) { return table.line[static_cast<std::size_t>(before + row)]; }};
}

double step_of(const RecordedTimes& time) {
  const Index steps = time.samples - 1;
  require(steps > 0, time.file + ": one sample only, expected two or more");
  const double first = time.times(0, 1)(0);
  const double mean = (time.times(steps, 1)(0) - first) / static_cast<double>(steps);
  if (!(mean > 0.0)) {
    tell_fault(time);
    fail(time, steps, "the time does not ascend");
  }
  const double step = time.times(1, 1)(0) - first;
  return std::abs(step - mean) < 1e-12 * std::abs(mean) ? step : mean;
}

void check_steps(const RecordedTimes& time, double step) {
  const double start = time.times(0, 1)(0);
  for (Index first = 0; first < time.samples; first += kPiece) {
    const auto some = time.times(first, std::min(kPiece, time.samples - first));
    for (Index i = 0; i < some.size(); ++i) {
      const double expected = start + step * static_cast<double>(first + i);
      if (std::abs(some(i) - expected) < 0.01 * step) continue;
      tell_fault(time);
      fail(time, first + i,
           fmt::format("{} is {:.9g}, expected {:.9g}: one step from sample to sample", time.name,
                       some(i), expected));
    }
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
  const auto of = [&](Side side) {
    const auto s = static_cast<std::size_t>(side);
    return samples(table, stretch, layout.columns[s], layout.factors[s]);
  };
  return {of(Side::output), of(Side::input), of(Side::reference), stretch.experiment,
          stretch.realisation};
}

std::string no_sample_time(const CsvTable& table) {
  return table.file +
         ": there is no column time_s, and no sample time is stated; a table of responses has a "
         "column freq_hz";
}

}  // namespace chladni::io
