#include "io/uff/uff_recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"
#include "io/uff/uff_channels.h"
#include "io/uff/uff_systems.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
constexpr long long kMostNumber = 1'000'000;  // of an experiment or realisation

std::string stated(const UffFunction& function, std::string_view mark) {
  for (const auto& id : function.id) {
    if (std::string_view(id).starts_with(mark)) return id.substr(mark.size());
  }
  return {};
}

std::string name_in(const UffFunction& function) {
  return stated_name(function, kResponseName, function.response);
}

std::pair<long long, int> degree_of(const UffFunction& function) {
  return {function.response.node, function.response.direction};
}

// Where a name is both a sensor's and an actuator's the file decides.
Side side_of(const UffFunction& function, const std::string& name, const TimeOptions& options) {
  const auto knows = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const bool is_sensor = knows(options.sensor_names);
  const bool is_actuator = knows(options.actuator_names);
  if (is_sensor != is_actuator) return is_sensor ? Side::output : Side::input;
  if (!is_sensor && knows(options.reference_names)) return Side::reference;
  const auto side = std::find(kUffSides.begin(), kUffSides.end(), stated(function, kUffSide));
  if (side != kUffSides.end()) return static_cast<Side>(side - kUffSides.begin());
  return function.ordinate.type == 13 || function.ordinate.type == 9 ? Side::input : Side::output;
}

bool has_part(const std::vector<UffPart>& parts, Side side, Index channel) {
  return std::any_of(parts.begin(), parts.end(), [&](const UffPart& part) {
    return part.side == side && part.channel == channel;
  });
}

// @param seconds  that 1 of the abscissa is
std::string time_fault_of(const Eigen::VectorXd& x, double step, double seconds) {
  if (!(step > 0.0)) return ": the time does not ascend";
  for (Index k = 0; k < x.size(); ++k) {
    if (std::abs(x(k) - x(0) - step * static_cast<double>(k)) < 0.01 * step) continue;
    return ": sample " + fmt::to_string(k + 1) + " is at " + fmt::format("{:.9g}", seconds * x(k)) +
           " s; expected one step from sample to sample";
  }
  return "";
}

}  // namespace

bool is_recording(const UffFunction& function) {
  return !function.is_complex &&
         (function.type == 1 || (function.type == 0 && function.abscissa.type == 17));
}

UffTrace trace_of(const UffFunction& function) {
  const auto& x = function.x;
  UffTrace trace;
  trace.count = function.y.size();
  trace.is_finite = function.y.allFinite();
  if (x.size() < 2) {
    trace.fault = ": one sample only, expected two or more";
    return trace;
  }
  const double step = (x(x.size() - 1) - x(0)) / static_cast<double>(x.size() - 1);
  const double seconds = abscissa_factor(function.abscissa, "s").value_or(1.0);
  trace.fault = time_fault_of(x, step, seconds);
  const double first = x(1) - x(0);
  trace.step = seconds * (std::abs(first - step) < 1e-12 * step ? first : step);
  trace.start = seconds * x(0);
  return trace;
}

UffNames::UffNames(const std::vector<UffFunction>& functions) {
  for (const auto& function : functions) {
    if (is_recording(function)) whose_[name_in(function)].insert(degree_of(function));
  }
}

std::string UffNames::of(const UffFunction& function) const {
  const auto name = name_in(function);
  const auto found = whose_.find(name);
  const bool is_one = found != whose_.end() && found->second.size() == 1 && !name.empty();
  return is_one ? name : name_of(function.response);
}

UffRecordings::UffRecordings(const Uff& uff, const std::vector<UffTrace>& traces,
                             const std::string& name, const TimeOptions& options)
    : uff_(uff), traces_(traces), name_(name), options_(options), names_(uff.functions) {
  file_.format = "UFF 58";
  file_.notes = uff_.notes;
  std::size_t others = 0;
  for (std::size_t f = 0; f < uff_.functions.size(); ++f) {
    if (uff_.functions[f].binary) file_.format = "UFF 58b";
    if (is_recording(uff_.functions[f])) {
      take(f);
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
}

void UffRecordings::fail(const std::string& what) const { throw InvalidInput(name_ + ": " + what); }

std::string UffRecordings::place(const UffFunction& function) const {
  return "line " + fmt::to_string(function.line) + " (" + names_.of(function) + ")";
}

std::string UffRecordings::place(const UffPart& part) const {
  return place(uff_.functions[part.function]);
}

std::vector<modal::MeasuredChannel>& UffRecordings::channels(Side side) {
  auto& data = file_.data;
  return side == Side::output ? data.outputs : side == Side::input ? data.inputs : data.references;
}

void UffRecordings::take(std::size_t f) {
  const auto& function = uff_.functions[f];
  const auto name = names_.of(function);
  const Side side = side_of(function, name, options_);
  auto& all = channels(side);
  auto found = std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.name == name; });
  const auto scale = side == Side::output
                         ? motion_scale(function)
                         : force_scale(function.response, function.ordinate, function.units);
  if (found == all.end()) {
    modal::MeasuredChannel channel;
    channel.name = name;
    channel.node = function.response.node;
    channel.direction = vector_of(function.response.direction);
    channel.unit = scale.unit;
    channel.kind = scale.kind.value_or(channel.kind);
    found = all.insert(all.end(), channel);
    if (side == Side::output) stated_kind_.push_back(scale.kind);
    note_once(scale.note);
  }
  const auto number = static_cast<Index>(found - all.begin());
  if (is_of_another_quantity(side, number, scale)) {
    fail(place(function) + ": the channel is of another kind or unit than in the function before");
  }
  if (!abscissa_factor(function.abscissa, "s")) note_once(unknown_abscissa(function.abscissa, "s"));
  Key key{function.load_case, function.version, 0};
  while (has_part(parts_[key], side, number)) ++key[2];
  parts_[key].push_back({f, side, number, scale.factor});
  take_sample_time(function, traces_[f]);
}

bool UffRecordings::is_of_another_quantity(Side side, Index number, const UffScale& scale) {
  const auto at = static_cast<std::size_t>(number);
  const auto kind = side == Side::output ? stated_kind_[at] : std::nullopt;
  if (kind && scale.kind && kind != scale.kind) return true;
  const auto& unit = channels(side)[at].unit;
  return !unit.empty() && !scale.unit.empty() && unit != scale.unit;
}

void UffRecordings::note_once(const std::string& note) {
  if (note.empty() || std::ranges::find(file_.notes, note) != file_.notes.end()) return;
  file_.notes.push_back(note);
}

void UffRecordings::take_sample_time(const UffFunction& function, const UffTrace& trace) {
  if (!trace.fault.empty()) fail(place(function) + trace.fault);
  if (file_.data.sample_time_s == 0.0) file_.data.sample_time_s = trace.step;
  if (std::abs(trace.step - file_.data.sample_time_s) < 1e-6 * trace.step) return;
  fail(place(function) + ": a sample each " + fmt::format("{:.9g}", trace.step) +
       " s, others each " + fmt::format("{:.9g}", file_.data.sample_time_s) + " s");
}

void UffRecordings::finish() {
  std::optional<double> length;
  if (uff_.units) length = uff_.units->length;
  for (const auto side : {Side::output, Side::input, Side::reference}) {
    place_channels(uff_, length, channels(side), file_.notes);
  }
  for (const auto& input : file_.data.inputs) note_unknown(input, file_.notes);
  note_unused(options_.unit, file_.data.outputs, file_.notes);
  const auto numbers = realisations();
  for (const auto& [key, parts] : parts_) {
    add_record(key[0], numbers.at({key[1], key[2]}), parts);
  }
  const auto& first = uff_.functions[parts_.begin()->second.front().function];
  const auto stated_period = integer_in(stated(first, kUffPeriod));
  if (stated_period.value_or(0) < 0) {
    fail(place(first) + ": a period of " + fmt::to_string(*stated_period) + " samples");
  }
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

void UffRecordings::state_unit() {
  const auto unit = stated_unit(options_.unit);
  stated_factor_.setOnes(std::ssize(file_.data.outputs));
  for (std::size_t c = 0; c < file_.data.outputs.size(); ++c) {
    auto& output = file_.data.outputs[c];
    if (!output.unit.empty() || options_.unit.empty()) continue;
    // A displacement counts for nothing: our own files call outputs of an unknown quantity so.
    const auto kind = stated_kind_[c].value_or(modal::FrfKind::receptance);
    if (kind != modal::FrfKind::receptance && unit.kind && kind != unit.kind) {
      fail("the unit \"" + options_.unit + "\" is none of what the file says of " + output.name +
           ": it is of another kind of motion");
    }
    output.unit = unit.si;
    output.kind = unit.kind.value_or(output.kind);
    stated_factor_(static_cast<Index>(c)) = unit.factor;
  }
}

std::map<UffRecordings::Taking, int> UffRecordings::realisations() const {
  std::map<Taking, int> numbers;
  bool are_versions = true;
  for (const auto& [key, parts] : parts_) {
    numbers.emplace(Taking(key[1], key[2]), 0);
    are_versions = are_versions && key[2] == 0 && key[1] >= 0 && key[1] <= kMostNumber;
  }
  int next = 0;
  for (auto& [taking, number] : numbers) {
    number = are_versions ? static_cast<int>(taking.first) : next++;
  }
  return numbers;
}

void UffRecordings::add_record(long long experiment, int realisation,
                               const std::vector<UffPart>& parts) {
  UffRecord record;
  const Index n = traces_[parts.front().function].count;
  const auto& data = file_.data;
  const bool is_only = parts_.begin()->first[0] == parts_.rbegin()->first[0];
  if (!is_only && (experiment < 0 || experiment > kMostNumber)) {
    fail(place(parts.front()) + ": the load case " + fmt::to_string(experiment) +
         ", expected 0 to " + fmt::to_string(kMostNumber));
  }
  record.experiment = static_cast<int>(std::clamp(experiment, 0LL, kMostNumber));
  record.realisation = realisation;
  record.samples = n;
  record.parts = parts;
  const auto all = data.outputs.size() + data.inputs.size() + data.references.size();
  if (parts.size() != all) {
    fail("the recording of " + place(parts.front()) + " has " + fmt::to_string(parts.size()) +
         " channels, there are " + fmt::to_string(all) + " in the file");
  }
  for (const auto& part : parts) {
    const auto& trace = traces_[part.function];
    if (trace.count != n) {
      fail("unequal lengths: " + place(parts.front()) + " has " + fmt::to_string(n) + " samples, " +
           place(part) + " has " + fmt::to_string(trace.count));
    }
    const double start = traces_[parts.front().function].start;
    if (std::abs(trace.start - start) > 0.01 * trace.step) {
      fail(fmt::format("unequal times: {} begins at {:.9g} s, {} at {:.9g} s", place(parts.front()),
                       start, place(part), trace.start));
    }
    if (!trace.is_finite) fail(place(part) + ": a sample is no number");
  }
  records_.push_back(std::move(record));
}

}  // namespace chladni::io
