#include "io/matlab/time_mat.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/error.h"
#include "io/matlab/mat_channels.h"
#include "io/matlab/mat_names.h"
#include "io/matlab/testlab_mat.h"
#include "io/matlab/time_sides.h"
#include "io/measured/frf_units.h"
#include "io/measured/measurable.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
using recordings::Record;

constexpr Index kMatPiece = 65536;  // numbers that are looked at at once

Eigen::VectorXd numbers_in_memory(const MatValue& value, Index first, Index count) {
  return value.real.segment(first, count);
}

constexpr double kBytesPerRecord = 320.0;  // three matrices and the allocator's overhead

// The number as a count, before it becomes an integer.
Index whole(const std::string& name, double value, double most) {
  require(value >= 0.0 && value <= most && value == std::floor(value),
          name + fmt::format(" is {:g}, expected a whole number, 0 or more", value));
  return static_cast<Index>(value);
}

// Real numbers, in memory or in the file.
void require_real(const MatValue& value, const std::string& name) {
  if (value.kind != MatValue::Kind::large) static_cast<void>(mat_numbers(&value, name));
}

class RecordReader {
 public:
  /// @param numbers  of the variables; empty: those in memory
  RecordReader(const MatFields& fields, const TimeOptions& options, TimeFile& file,
               MatNumbers numbers = {})
      : fields_(fields),
        options_(options),
        data_(file.data),
        notes_(file.notes),
        is_whole_(!numbers),
        numbers_(is_whole_ ? &numbers_in_memory : std::move(numbers)) {}

  void read() {
    find_size();
    require_room(kBytesPerRecord * static_cast<double>(records_), options_.limit_bytes,
                 fmt::to_string(records_) + " records");
    data_.records.resize(static_cast<std::size_t>(records_));
    for (std::size_t s = 0; s < 3; ++s) read_side(s);
    require(!data_.outputs.empty() || !data_.inputs.empty(),
            "there are no recordings; expected variables y and u");
    data_.sample_time_s = sample_time();
    const auto period = mat_number(mat_value(fields_, {"period"}), "period");
    const auto stated = period ? whole("period", *period, 1e15) : 0;
    data_.period = options_.period > 0 ? options_.period : stated;
    number_records();
    const auto kinds = known_kinds();
    take_one_unit();
    state_units(kinds);
    if (!is_whole_) check_head();
    note_rest();
  }

  /// The recordings without their samples, which the numbers have.
  [[nodiscard]] recordings::Recordings recordings() const {
    recordings::Recordings result;
    result.head = data_;
    result.head.records.clear();
    for (const auto& record : data_.records) {
      result.records.push_back({samples_, record.experiment, record.realisation});
    }
    result.samples = [numbers = numbers_, of_side = of_side_, factors = factors_, n = samples_](
                         std::size_t record, recordings::Side side, Index channel, Index first,
                         Index count) -> Eigen::VectorXd {
      const auto s = static_cast<std::size_t>(side);
      const Index channels = factors[s].size();
      const Index before = (static_cast<Index>(record) * channels + channel) * n;
      return factors[s](channel) * numbers(*of_side[s], before + first, count);
    };
    return result;
  }

 private:
  // Notes the variables that are not read.
  void note_rest() {
    std::vector<std::string> names{"kind", "period", "experiment", "realisation"};
    for (const char* side : kSide) {
      for (const char* what : {"_names", "_unit", "_node", "_direction", "_position"}) {
        names.push_back(std::string(side) + what);
      }
    }
    names.insert(names.end(), {"OutputUnit", "InputUnit"});
    lookup_.note_rest({names.begin(), names.end()}, notes_);
  }

  static Index samples_of(const MatValue& value) {
    return value.dims[0] == 1 && value.dims.size() == 2 ? value.dims[1] : value.dims[0];
  }

  // Finds the numbers of samples and records from the first variable with values, y before the
  // others. All sides share them. A row counts as one channel.
  void find_size() {
    for (std::size_t s = 0; s < 3; ++s) {
      const auto* value = variable_of(fields_, s);
      if (value == nullptr || value->size() == 0) continue;
      require(has_numbers(value) && value->dims.size() <= 3,
              std::string(kVariable[s]) + " is a " + value->class_name + " of " + mat_size(*value) +
                  ", expected samples x channels x records");
      samples_ = samples_of(*value);
      records_ = value->dims.size() == 3 ? value->dims[2] : 1;
      return;
    }
  }

  void read_side(std::size_t side) {
    const auto* value = variable_of(fields_, side);
    Index count = 0;
    if (value != nullptr && value->size() > 0) {
      require_real(*value, kVariable[side]);
      require_finite(*value, kVariable[side]);
      const Index each = samples_ * records_;
      const bool fits = samples_of(*value) == samples_ && value->dims.size() <= 3 &&
                        (value->dims.size() < 3 || value->dims[2] == records_);
      require(fits && value->size() % each == 0, std::string(kVariable[side]) + " is " +
                                                     mat_size(*value) + ", expected " +
                                                     fmt::to_string(samples_) + " samples of " +
                                                     fmt::to_string(records_) + " records");
      count = value->size() / each;
      require_channels(count, std::string(kSide[side]) + "s");
      require(count <= samples_,
              fmt::format("{} is {}: {} channels of {} samples; expected samples x channels",
                          kVariable[side], mat_size(*value), count, samples_));
    }
    factors_[side] = Eigen::VectorXd::Ones(count);
    of_side_[side] = value;
    lookup_.count_as_read(value);
    for (Index r = 0; r < records_ && is_whole_; ++r) {
      auto& part = data_.records[static_cast<std::size_t>(r)].*kSamplesOf[side];
      part.resize(samples_, count);
      if (count == 0) continue;
      part = numbers_(*value, r * samples_ * count, samples_ * count).reshaped(samples_, count);
    }
    name_channels(side, count);
  }

  void require_finite(const MatValue& value, const std::string& name) const {
    for (Index first = 0; first < value.size(); first += kMatPiece) {
      const auto some = numbers_(value, first, std::min(kMatPiece, value.size() - first));
      for (Index n = 0; n < some.size(); ++n) {
        require(std::isfinite(some(n)) && is_measurable(some(n)),
                name + "(" + fmt::to_string(first + n + 1) + "): " + not_measurable(some(n)));
      }
    }
  }

  void name_channels(std::size_t side, Index count) {
    auto& channels = side == 0 ? data_.outputs : side == 1 ? data_.inputs : data_.references;
    const std::string key = kSide[side];
    auto names = mat_texts(mat_value(fields_, {key + "_names"}), key + "_names");
    const auto& known = side == 0   ? options_.sensor_names
                        : side == 1 ? options_.actuator_names
                                    : options_.reference_names;
    if (names.empty() && static_cast<Index>(known.size()) == count) names = known;
    require(names.empty() || static_cast<Index>(names.size()) == count,
            fmt::to_string(names.size()) + " names for " + fmt::to_string(count) + " " + key + "s");
    for (Index c = 0; c < count; ++c) {
      const auto at = static_cast<std::size_t>(c);
      auto& channel = channels.emplace_back();
      channel.name = names.empty() ? kVariable[side] + fmt::to_string(c + 1) : names[at];
    }
    describe_channels(fields_, key, channels);
  }

  [[nodiscard]] double sample_time() {
    if (const auto stated = mat_number(lookup_.find({"sample_time_s", "Ts", "dt"}), "Ts")) {
      require(*stated > 0.0, fmt::format("Ts is {:g}, expected a time above 0", *stated));
      require_same_step(*stated);
      return *stated;
    }
    const auto filled = [](const MatValue* value) {
      return value != nullptr && value->size() > 0 ? value : nullptr;
    };
    const auto* time = filled(times());
    const auto rate = mat_number(
        time != nullptr ? nullptr : lookup_.find({"sample_rate_hz", "sample_rate", "fs"}), "fs");
    require(!rate || *rate > 0.0,
            fmt::format("fs is {:g}, expected a rate above 0", rate.value_or(0.0)));
    if (rate) return 1.0 / *rate;
    if (time == nullptr) time = filled(lookup_.find({"time_s", "time", "t"}));
    if (time == nullptr && options_.sample_time_s > 0.0) return options_.sample_time_s;
    require(time != nullptr && time->size() > 1,
            "there is no sample_time_s, and no time_s or fs either");
    lookup_.count_as_read(time);
    return step_of_times(*time);
  }

  // The times; T is none, but may be a temperature.
  [[nodiscard]] const MatValue* times() const {
    const auto is_t = [](const auto& field) { return field.first == "t"; };
    const auto t = std::ranges::find_if(fields_, is_t);
    const auto* time = mat_value(fields_, {"time_s", "time"});
    return time == nullptr && t != fields_.end() ? &t->second : time;
  }

  // Times beside a stated sample time must have that step; others are not read.
  void require_same_step(double stated) {
    const auto* time = times();
    if (!has_numbers(time) || time->size() != samples_ || time->size() < 2) return;
    double step = 0.0;
    try {
      step = step_of_times(*time);
    } catch (const InvalidInput& uneven) {
      lookup_.count_as_read(time);
      notes_.push_back(std::string("the times beside a sample time are not read: ") +
                       uneven.what());
      return;
    }
    require(std::abs(step / stated - 1.0) < 0.01,
            fmt::format("the sample time is {:g} s, time_s has steps of {:g} s", stated, step));
    lookup_.count_as_read(time);
  }

  [[nodiscard]] double step_of_times(const MatValue& time) const {
    require_real(time, "time_s");
    const Index count = time.size();
    require(count == samples_, "time_s has " + fmt::to_string(count) + " entries, expected " +
                                   fmt::to_string(samples_));
    const auto at = [&](Index k) { return numbers_(time, k, 1)(0); };
    const double start = at(0);
    const double step = (at(count - 1) - start) / static_cast<double>(count - 1);
    for (Index from = 0; from < count; from += kMatPiece) {
      const auto some = numbers_(time, from, std::min(kMatPiece, count - from));
      for (Index n = 0; n < some.size(); ++n) {
        const double off = some(n) - start - step * static_cast<double>(from + n);
        require(step > 0.0 && std::abs(off) < 0.01 * step,
                "time_s(" + fmt::to_string(from + n + 1) + ") is " +
                    fmt::format("{:.9g}", some(n)) + "; expected one step from sample to sample");
      }
    }
    const double first = at(1) - start;
    return std::abs(first - step) < 1e-12 * step ? first : step;
  }

  void number_records() {
    const auto number = [&](const char* name, int Record::*of) {
      const auto numbers = mat_numbers(mat_value(fields_, {name}), name);
      require(numbers.size() == 0 || numbers.size() == records_,
              std::string(name) + " has " + fmt::to_string(numbers.size()) +
                  " entries, expected one per record: " + fmt::to_string(records_));
      for (Index r = 0; r < numbers.size(); ++r) {
        data_.records[static_cast<std::size_t>(r)].*of =
            static_cast<int>(whole(name, numbers(r), 1e6));
      }
      return numbers.size() > 0;
    };
    const bool experiments = number("experiment", &Record::experiment);
    if (number("realisation", &Record::realisation) || experiments) return;
    for (Index r = 0; r < records_; ++r) {
      data_.records[static_cast<std::size_t>(r)].realisation = static_cast<int>(r);
    }
  }

  // Whether the file says what each output measures. A variable of that name with other
  // contents is another program's.
  std::vector<bool> known_kinds() {
    auto outputs = data_.outputs;
    try {
      auto known = read_kinds(fields_, outputs);
      data_.outputs = std::move(outputs);
      return known;
    } catch (const InvalidInput& other) {
      notes_.push_back(std::string("the variable kind is left out: ") + other.what());
      return std::vector<bool>(data_.outputs.size(), false);
    }
  }

  // Takes the unit of all outputs; what is none of them is another program's, as of known_kinds.
  void take_one_unit() {
    try {
      if (state_one_unit(fields_, data_.outputs)) lookup_.find({"unit", "units"});
    } catch (const InvalidInput& other) {
      lookup_.find({"unit", "units"});
      notes_.push_back(std::string("the variable unit is left out: ") + other.what());
    }
  }

  // What check() says of channels and sampling, where the samples are in the file.
  void check_head() const {
    auto head = data_;
    head.records.resize(1);
    for (std::size_t s = 0; s < 3; ++s) {
      head.records.front().*kSamplesOf[s] = Eigen::MatrixXd::Zero(1, factors_[s].size());
    }
    recordings::check(head);
  }

  // @param is_stated  of each output, whether the file says what it measures
  void state_units(const std::vector<bool>& is_stated) {
    const auto stated = stated_unit(options_.unit);
    note_unused(options_.unit, data_.outputs, notes_);
    for (std::size_t c = 0; c < data_.outputs.size(); ++c) {
      auto& output = data_.outputs[c];
      const auto unit = output.unit.empty() ? std::optional(stated) : motion_unit(output.unit);
      if (output.unit.empty()) output.unit = stated.si;
      if (output.unit.empty() && options_.unit.empty() && c == 0) {
        notes_.push_back("the unit of " + output.name + " is not stated: values are as they stand");
      }
      if (!unit) note_unknown_output(output, notes_);
      if (!unit || !unit->kind) continue;
      require(!is_stated[c] || output.kind == *unit->kind,
              output.name + ": its unit " + unit->si + " and what kind says contradict each other");
      output.unit = unit->si;
      output.kind = *unit->kind;
      take_factor(0, c, unit->factor);
    }
    for (std::size_t c = 0; c < data_.inputs.size(); ++c) {
      note_unknown(data_.inputs[c], notes_);
      const auto force = force_unit(data_.inputs[c].unit);
      if (!force) continue;
      data_.inputs[c].unit = "N";
      take_factor(1, c, *force);
    }
  }

  void take_factor(std::size_t side, std::size_t channel, double factor) {
    const auto column = static_cast<Index>(channel);
    factors_[side](column) = factor;
    for (auto& record : data_.records) {
      if (is_whole_) (record.*kSamplesOf[side]).col(column) *= factor;
    }
  }

  const MatFields& fields_;
  const TimeOptions& options_;
  recordings::TimeData& data_;
  std::vector<std::string>& notes_;
  bool is_whole_ = true;
  MatNumbers numbers_;
  MatLookup lookup_{fields_};
  Index samples_ = 0, records_ = 1;
  std::array<Eigen::VectorXd, 3> factors_;  ///< SI value of 1 in each channel of a side
  std::array<const MatValue*, 3> of_side_{};
};

}  // namespace

TimeFile time_of_mat(const MatFile& file, const std::string& name, const TimeOptions& options) {
  TimeFile result{.format = file.format, .data = {}, .notes = file.notes};
  try {
    const bool has_plain = has_numbers(mat_value(file.variables, {"y"})) ||
                           has_numbers(mat_value(file.variables, {"u"}));
    if (has_testlab_functions(file.variables) && !has_plain) {
      const auto functions = testlab_recordings(file.variables, options, result.notes);
      require(functions.has_value(), "functions, but no recordings");
      RecordReader(*functions, options, result).read();
      return result;
    }
    RecordReader(file.variables, options, result).read();
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what());
  }
  return result;
}

RecordingsFile recordings_of_mat(const MatFile& file, const std::string& name,
                                 const TimeOptions& options, const MatNumbers& numbers) {
  TimeFile head{.format = file.format, .data = {}, .notes = file.notes};
  try {
    RecordReader reader(file.variables, options, head, numbers);
    reader.read();
    return {head.format, reader.recordings(), head.notes};
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what());
  }
}

}  // namespace chladni::io
