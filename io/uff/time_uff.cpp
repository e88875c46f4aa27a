#include "io/uff/time_uff.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/error.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"
#include "io/uff/uff_channels.h"
#include "io/uff/uff_systems.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
using recordings::Record;
constexpr std::string_view kSide = "side: ", kPeriod = "period: ";
constexpr std::array<std::string_view, 3> kSides{"output", "input", "reference"};
constexpr std::array<Eigen::MatrixXd Record::*, 3> kParts{&Record::outputs, &Record::inputs,
                                                          &Record::references};

bool is_recording(const UffFunction& function) {
  return !function.is_complex &&
         (function.type == 1 || (function.type == 0 && function.abscissa.type == 17));
}

std::string stated(const UffFunction& function, std::string_view mark) {
  for (const auto& id : function.id) {
    if (std::string_view(id).starts_with(mark)) return id.substr(mark.size());
  }
  return {};
}

// The names of channels. Degrees of freedom that share a name in the file get names made of node
// and direction.
class Names {
 public:
  explicit Names(const std::vector<UffFunction>& functions) {
    for (const auto& function : functions) {
      if (is_recording(function)) whose_[stated(function)].insert(degree(function));
    }
  }

  [[nodiscard]] std::string of(const UffFunction& function) const {
    const auto name = stated(function);
    const auto found = whose_.find(name);
    const bool is_one = found != whose_.end() && found->second.size() == 1 && !name.empty();
    return is_one ? name : name_of(function.response);
  }

 private:
  using Degree = std::pair<long long, int>;

  static std::string stated(const UffFunction& function) {
    return stated_name(function, kResponseName, function.response);
  }
  static Degree degree(const UffFunction& function) {
    return {function.response.node, function.response.direction};
  }

  std::map<std::string, std::set<Degree>> whose_;
};

Side side_of(const UffFunction& function, const std::string& name, const TimeOptions& options) {
  const auto knows = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (knows(options.sensor_names)) return Side::output;
  if (knows(options.actuator_names)) return Side::input;
  if (knows(options.reference_names)) return Side::reference;
  const auto side = std::find(kSides.begin(), kSides.end(), stated(function, kSide));
  if (side != kSides.end()) return static_cast<Side>(side - kSides.begin());
  return function.ordinate.type == 13 || function.ordinate.type == 9 ? Side::input : Side::output;
}

class RecordCollector {
 public:
  RecordCollector(const Uff& uff, const std::string& name, const TimeOptions& options)
      : uff_(uff), name_(name), options_(options), names_(uff.functions) {}

  TimeFile file() {
    file_.format = "UFF 58";
    file_.notes = uff_.notes;
    std::size_t others = 0;
    for (const auto& function : uff_.functions) {
      if (function.binary) file_.format = "UFF 58b";
      if (is_recording(function)) {
        take(function);
      } else {
        ++others;
      }
    }
    if (parts_.empty()) {
      fail("no time response (dataset 58, function type 1) among " +
           fmt::to_string(uff_.functions.size()) + " functions");
    }
    if (others > 0) {
      file_.notes.push_back(fmt::to_string(others) + " other functions: not read");
    }
    finish();
    return std::move(file_);
  }

 private:
  using Key = std::array<long long, 3>;  // experiment, realisation, count within its channel
  struct Part {
    const UffFunction* function;
    Side side;
    Index channel;
    double factor;
  };

  [[noreturn]] void fail(const std::string& what) const { throw InvalidInput(name_ + ": " + what); }

  [[nodiscard]] std::string place(const UffFunction& function) const {
    return "line " + fmt::to_string(function.line) + " (" + names_.of(function) + ")";
  }

  std::vector<modal::MeasuredChannel>& channels(Side side) {
    auto& data = file_.data;
    return side == Side::output  ? data.outputs
           : side == Side::input ? data.inputs
                                 : data.references;
  }

  void take(const UffFunction& function) {
    const auto name = names_.of(function);
    const Side side = side_of(function, name, options_);
    auto& all = channels(side);
    auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.name == name; });
    const auto scale = side == Side::output ? motion_scale(function.ordinate, function.units)
                                            : force_scale(function.ordinate, function.units);
    if (found == all.end()) {
      modal::MeasuredChannel channel;
      channel.name = name;
      channel.node = function.response.node;
      channel.direction = vector_of(function.response.direction);
      channel.unit = scale.unit;
      channel.kind = scale.kind.value_or(channel.kind);
      found = all.insert(all.end(), channel);
    }
    Key key{function.load_case, function.version, 0};
    const auto number = static_cast<Index>(found - all.begin());
    while (has(parts_[key], side, number)) ++key[2];
    parts_[key].push_back({&function, side, number, scale.factor});
    sample_time(function);
  }

  static bool has(const std::vector<Part>& parts, Side side, Index channel) {
    return std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
      return part.side == side && part.channel == channel;
    });
  }

  void sample_time(const UffFunction& function) {
    const auto& x = function.x;
    if (x.size() < 2) fail(place(function) + ": one sample only, expected two or more");
    const double step = (x(x.size() - 1) - x(0)) / static_cast<double>(x.size() - 1);
    if (!(step > 0.0)) fail(place(function) + ": the time does not ascend");
    for (Index k = 0; k < x.size(); ++k) {
      if (std::abs(x(k) - x(0) - step * static_cast<double>(k)) < 0.01 * step) continue;
      fail(place(function) + ": sample " + fmt::to_string(k + 1) + " is at " +
           fmt::format("{:.9g}", x(k)) + " s; expected one step from sample to sample");
    }
    const double first = x(1) - x(0);
    const double found = std::abs(first - step) < 1e-12 * step ? first : step;
    if (file_.data.sample_time_s == 0.0) file_.data.sample_time_s = found;
    if (std::abs(found - file_.data.sample_time_s) < 1e-6 * found) return;
    fail(place(function) + ": a sample each " + fmt::format("{:.9g}", found) + " s, others each " +
         fmt::format("{:.9g}", file_.data.sample_time_s) + " s");
  }

  void finish() {
    std::optional<double> length;
    if (uff_.units) length = uff_.units->length;
    for (const auto side : {Side::output, Side::input, Side::reference}) {
      place_channels(uff_, length, channels(side), file_.notes);
    }
    for (const auto& [key, parts] : parts_) add_record(key, parts);
    const auto stated_period =
        integer_in(stated(*parts_.begin()->second.front().function, kPeriod));
    file_.data.period = options_.period > 0 ? options_.period : stated_period.value_or(0);
    for (auto& output : file_.data.outputs) {
      if (output.unit.empty() && !options_.unit.empty()) continue;
      if (output.unit.empty()) {
        file_.notes.push_back("the unit of " + output.name +
                              " is not stated: values are as they stand");
        break;
      }
    }
    state_unit();
  }

  void state_unit() {
    const auto unit = stated_unit(options_.unit);
    for (std::size_t c = 0; c < file_.data.outputs.size(); ++c) {
      auto& output = file_.data.outputs[c];
      if (!output.unit.empty() || options_.unit.empty()) continue;
      output.unit = unit.si;
      output.kind = unit.kind.value_or(output.kind);
      for (auto& record : file_.data.records) {
        record.outputs.col(static_cast<Index>(c)) *= unit.factor;
      }
    }
  }

  void add_record(const Key& key, const std::vector<Part>& parts) {
    Record record;
    const Index n = parts.front().function->y.size();
    const auto& data = file_.data;
    record.outputs.setZero(n, static_cast<Index>(data.outputs.size()));
    record.inputs.setZero(n, static_cast<Index>(data.inputs.size()));
    record.references.setZero(n, static_cast<Index>(data.references.size()));
    record.experiment = static_cast<int>(std::clamp(key[0], 0LL, 1'000'000LL));
    record.realisation = static_cast<int>(std::clamp(key[1], 0LL, 1'000'000LL) + key[2]);
    const auto all = data.outputs.size() + data.inputs.size() + data.references.size();
    if (parts.size() != all) {
      fail("the recording of " + place(*parts.front().function) + " has " +
           fmt::to_string(parts.size()) + " channels, there are " + fmt::to_string(all) +
           " in the file");
    }
    for (const auto& part : parts) {
      if (part.function->y.size() != n) {
        fail("unequal lengths: " + place(*parts.front().function) + " has " + fmt::to_string(n) +
             " samples, " + place(*part.function) + " has " +
             fmt::to_string(part.function->y.size()));
      }
      if (!part.function->y.allFinite()) fail(place(*part.function) + ": a sample is no number");
      (record.*kParts[static_cast<std::size_t>(part.side)]).col(part.channel) =
          part.factor * part.function->y.real();
    }
    file_.data.records.push_back(std::move(record));
  }

  const Uff& uff_;
  const std::string& name_;
  const TimeOptions& options_;
  Names names_;
  TimeFile file_;
  std::map<Key, std::vector<Part>> parts_;
};

UffAxis ordinate_of(const modal::MeasuredChannel& channel, Side side) {
  constexpr std::array<int, 3> types{8, 11, 12};
  constexpr std::array<const char*, 3> labels{"Displacement", "Velocity", "Acceleration"};
  UffAxis axis;
  axis.unit = channel.unit;
  const auto kind = static_cast<std::size_t>(channel.kind);
  if (side == Side::output) {
    axis.label = labels[kind];
    if (motion_unit(channel.unit)) axis.type = types[kind];
  } else if (force_unit(channel.unit)) {
    axis.type = 13;
    axis.label = "Excitation";
  }
  return axis;
}

}  // namespace

TimeFile parse_time_uff(std::string_view bytes, const std::string& name,
                        const TimeOptions& options) {
  const Uff uff = parse_uff(bytes, name, options.limit_bytes);
  return RecordCollector(uff, name, options).file();
}

std::string time_uff(const recordings::TimeData& data, UffEncoding encoding) {
  std::string text = uff_head("recordings", {});
  const std::array sides{&data.outputs, &data.inputs, &data.references};
  UffFunction function;
  function.type = 1;
  function.abscissa.type = 17;
  function.abscissa.label = "Time";
  function.abscissa.unit = "s";
  if (data.period > 0) function.id[2] = std::string(kPeriod) + fmt::to_string(data.period);
  for (const auto& record : data.records) {
    function.load_case = record.experiment;
    function.version = record.realisation;
    for (std::size_t s = 0; s < 3; ++s) {
      const auto dofs = dofs_of(*sides[s], {});
      const auto& samples = record.*kParts[s];
      function.id[4] = std::string(kSide) + std::string(kSides[s]);
      for (std::size_t c = 0; c < sides[s]->size(); ++c) {
        const auto& channel = (*sides[s])[c];
        require(channel.name.size() <= 60 && trimmed(channel.name) == channel.name &&
                    channel.name.find_first_of("\r\n") == std::string::npos,
                "UFF cannot hold the channel name " + shown(channel.name));
        function.id[3] = std::string(kResponseName) + channel.name;
        function.response = dofs[c];
        function.ordinate = ordinate_of(channel, static_cast<Side>(s));
        function.x = Eigen::VectorXd::LinSpaced(samples.rows(), 0.0,
                                                static_cast<double>(samples.rows() - 1)) *
                     data.sample_time_s;
        function.y = samples.col(static_cast<Index>(c)).cast<std::complex<double>>();
        text += uff_dataset(function, encoding);
      }
    }
  }
  return text;
}

}  // namespace chladni::io
