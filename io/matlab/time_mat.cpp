#include "io/matlab/time_mat.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "io/matlab/mat_channels.h"
#include "io/matlab/mat_names.h"
#include "io/measured/frf_units.h"
#include "io/measured/measurable.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
using recordings::Record;

constexpr std::array<const char*, 3> kVariable{"y", "u", "r"};
constexpr std::array<const char*, 3> kSide{"output", "input", "reference"};
constexpr std::array<Eigen::MatrixXd Record::*, 3> kParts{&Record::outputs, &Record::inputs,
                                                          &Record::references};

constexpr double kBytesPerRecord = 320.0;  // three matrices and the allocator's overhead

// The number as a count, before it becomes an integer.
Index whole(const std::string& name, double value, double most) {
  require(value >= 0.0 && value <= most && value == std::floor(value),
          name + fmt::format(" is {:g}, expected a whole number, 0 or more", value));
  return static_cast<Index>(value);
}

class RecordReader {
 public:
  RecordReader(const MatFields& fields, const TimeOptions& options, TimeFile& file)
      : fields_(fields), options_(options), data_(file.data), notes_(file.notes) {}

  void read() {
    find_size();
    require_room(kBytesPerRecord * static_cast<double>(records_), options_.limit_bytes,
                 fmt::to_string(records_) + " records");
    data_.records.resize(static_cast<std::size_t>(records_));
    for (std::size_t s = 0; s < 3; ++s) read_side(s);
    require(!data_.outputs.empty() || !data_.inputs.empty(),
            "there are no recordings; expected variables y and u");
    data_.sample_time_s = sample_time();
    const auto period = mat_numbers(mat_value(fields_, {"period"}), "period");
    const auto stated = period.size() == 1 ? whole("period", period(0), 1e15) : 0;
    data_.period = options_.period > 0 ? options_.period : stated;
    number_records();
    state_units(known_kinds());
  }

 private:
  [[nodiscard]] const MatValue* variable(std::size_t side) const {
    return side == 0   ? mat_value(fields_, {"y", "outputs", "output"})
           : side == 1 ? mat_value(fields_, {"u", "inputs", "input", "force"})
                       : mat_value(fields_, {"r", "references", "reference"});
  }

  static Index samples_of(const MatValue& value) {
    return value.dims[0] == 1 && value.dims.size() == 2 ? value.dims[1] : value.dims[0];
  }

  // Finds the numbers of samples and records from the first variable with values, y before the
  // others. All sides share them. A row counts as one channel.
  void find_size() {
    for (std::size_t s = 0; s < 3; ++s) {
      const auto* value = variable(s);
      if (value == nullptr || value->size() == 0) continue;
      require(value->kind == MatValue::Kind::number && value->dims.size() <= 3,
              std::string(kVariable[s]) + " is a " + value->class_name + " of " + mat_size(*value) +
                  ", expected samples x channels x records");
      samples_ = samples_of(*value);
      records_ = value->dims.size() == 3 ? value->dims[2] : 1;
      return;
    }
  }

  void read_side(std::size_t side) {
    const auto* value = variable(side);
    Index count = 0;
    Eigen::VectorXd numbers;
    if (value != nullptr && value->size() > 0) {
      numbers = mat_numbers(value, kVariable[side]);
      for (Index n = 0; n < numbers.size(); ++n) {
        require(std::isfinite(numbers(n)) && is_measurable(numbers(n)),
                std::string(kVariable[side]) + "(" + fmt::to_string(n + 1) +
                    "): " + not_measurable(numbers(n)));
      }
      const Index each = samples_ * records_;
      const bool fits = samples_of(*value) == samples_ && value->dims.size() <= 3 &&
                        (value->dims.size() < 3 || value->dims[2] == records_);
      require(fits && numbers.size() % each == 0, std::string(kVariable[side]) + " is " +
                                                      mat_size(*value) + ", expected " +
                                                      fmt::to_string(samples_) + " samples of " +
                                                      fmt::to_string(records_) + " records");
      count = numbers.size() / each;
      require_channels(count, std::string(kSide[side]) + "s");
      require(count <= samples_,
              fmt::format("{} is {}: {} channels of {} samples; expected samples x channels",
                          kVariable[side], mat_size(*value), count, samples_));
    }
    for (Index r = 0; r < records_; ++r) {
      auto& part = data_.records[static_cast<std::size_t>(r)].*kParts[side];
      part =
          Eigen::Map<const Eigen::MatrixXd>(numbers.data() + r * samples_ * count, samples_, count);
    }
    name_channels(side, count);
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

  [[nodiscard]] double sample_time() const {
    const auto stated = mat_numbers(mat_value(fields_, {"sample_time_s", "Ts", "dt"}), "Ts");
    if (stated.size() == 1 && stated(0) > 0.0) return stated(0);
    const auto time = mat_numbers(mat_value(fields_, {"time_s", "time", "t"}), "time_s");
    const auto rate =
        mat_numbers(mat_value(fields_, {"sample_rate_hz", "sample_rate", "fs"}), "fs");
    if (time.size() == 0 && rate.size() == 1 && rate(0) > 0.0) return 1.0 / rate(0);
    if (time.size() == 0 && options_.sample_time_s > 0.0) return options_.sample_time_s;
    require(time.size() > 1, "there is no sample_time_s, and no time_s or fs either");
    require(time.size() == samples_, "time_s has " + fmt::to_string(time.size()) +
                                         " entries, expected " + fmt::to_string(samples_));
    const double step = (time(time.size() - 1) - time(0)) / static_cast<double>(time.size() - 1);
    for (Index k = 0; k < time.size(); ++k) {
      require(
          step > 0.0 && std::abs(time(k) - time(0) - step * static_cast<double>(k)) < 0.01 * step,
          "time_s(" + fmt::to_string(k + 1) + ") is " + fmt::format("{:.9g}", time(k)) +
              "; expected one step from sample to sample");
    }
    const double first = time(1) - time(0);
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
      if (!unit || !unit->kind) continue;
      require(!is_stated[c] || output.kind == *unit->kind,
              output.name + ": its unit " + unit->si + " and what kind says contradict each other");
      output.unit = unit->si;
      output.kind = *unit->kind;
      for (auto& record : data_.records) {
        record.outputs.col(static_cast<Index>(c)) *= unit->factor;
      }
    }
    for (std::size_t c = 0; c < data_.inputs.size(); ++c) {
      note_unknown(data_.inputs[c], notes_);
      const auto force = force_unit(data_.inputs[c].unit);
      if (!force) continue;
      data_.inputs[c].unit = "N";
      for (auto& record : data_.records) record.inputs.col(static_cast<Index>(c)) *= *force;
    }
  }

  const MatFields& fields_;
  const TimeOptions& options_;
  recordings::TimeData& data_;
  std::vector<std::string>& notes_;
  Index samples_ = 0, records_ = 1;
};

}  // namespace

TimeFile time_of_mat(const MatFile& file, const std::string& name, const TimeOptions& options) {
  TimeFile result{.format = file.format, .data = {}, .notes = file.notes};
  try {
    RecordReader(file.variables, options, result).read();
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what());
  }
  return result;
}

MatFields mat_of_time(const recordings::TimeData& data) {
  MatFields fields;
  const auto records = static_cast<Index>(data.records.size());
  const Index samples = data.records.empty() ? 0 : data.records.front().outputs.rows();
  const std::array sides{&data.outputs, &data.inputs, &data.references};
  Eigen::MatrixXd experiment(records, 1);
  Eigen::MatrixXd realisation(records, 1);
  for (std::size_t s = 0; s < 3; ++s) {
    if (sides[s]->empty()) continue;
    const auto count = static_cast<Index>(sides[s]->size());
    Eigen::VectorXd numbers(samples * count * records);
    for (Index r = 0; r < records; ++r) {
      const auto& record = data.records[static_cast<std::size_t>(r)];
      const auto& part = record.*kParts[s];
      require(part.rows() == samples && part.cols() == count,
              "MAT: record " + fmt::to_string(r + 1) + " has " + fmt::to_string(part.rows()) +
                  " samples of " + kSide[s] + "s, the first has " + fmt::to_string(samples));
      numbers.segment(r * samples * count, samples * count) = part.reshaped();
      experiment(r) = record.experiment;
      realisation(r) = record.realisation;
    }
    fields.emplace_back(kVariable[s], MatValue({samples, count, records}, std::move(numbers)));
    add_channels(fields, kSide[s], *sides[s]);
  }
  add_kinds(fields, data.outputs);
  fields.emplace_back("sample_time_s", data.sample_time_s);
  if (data.period > 0) fields.emplace_back("period", static_cast<double>(data.period));
  fields.emplace_back("experiment", experiment);
  fields.emplace_back("realisation", realisation);
  return fields;
}

}  // namespace chladni::io
