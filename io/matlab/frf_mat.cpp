#include "io/matlab/frf_mat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "base/error.h"
#include "io/matlab/mat_channels.h"
#include "io/matlab/mat_names.h"
#include "io/matlab/testlab_mat.h"
#include "io/measured/frf_units.h"
#include "io/measured/measurable.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

// Names of the variables, the first that is there counts.
const std::initializer_list<std::string_view> kResponseNames{"H", "G", "frf", "ResponseData"};
const std::initializer_list<std::string_view> kFrequencyNames{
    "freq_hz", "frequency_hz", "f_hz", "freqHz", "frequency", "freq", "f", "freqs", "omega", "w"};

/// The positions of lines, outputs and inputs in an array.
struct Layout {
  Index lines = 0, outputs = 0, inputs = 0;
  Index line_step = 0, output_step = 0, input_step = 0;

  [[nodiscard]] Index at(Index k, Index i, Index j) const {
    return k * line_step + i * output_step + j * input_step;
  }
};

// Hz of a unit of frequency as MATLAB names them: rpm, kHz, rad/s, cycles/TimeUnit, rad/minute.
double hz_of(const std::string& unit, const std::string& time_unit) {
  static const std::map<std::string, double, std::less<>> plain{
      {"HZ", 1.0}, {"KHZ", 1e3}, {"MHZ", 1e6}, {"GHZ", 1e9}, {"RPM", 1.0 / 60.0}};
  static const std::map<std::string, double, std::less<>> seconds{{"", 1.0},
                                                                  {"S", 1.0},
                                                                  {"SECOND", 1.0},
                                                                  {"MILLISECOND", 1e-3},
                                                                  {"MICROSECOND", 1e-6},
                                                                  {"NANOSECOND", 1e-9},
                                                                  {"MINUTE", 60.0},
                                                                  {"HOUR", 3600.0},
                                                                  {"DAY", 86400.0}};
  const auto text = upper(unit);
  if (const auto found = plain.find(text); found != plain.end()) return found->second;
  const auto slash = text.find('/');
  const auto turns = text.substr(0, slash);
  if (slash != std::string::npos && (turns == "RAD" || turns == "CYCLES")) {
    auto per = text.substr(slash + 1);
    if (per == "TIMEUNIT") per = upper(time_unit);
    if (per.size() > 1 && per.back() == 'S') per.pop_back();  // seconds
    if (const auto found = seconds.find(per); found != seconds.end()) {
      return (turns == "RAD" ? 1.0 / (2.0 * std::numbers::pi) : 1.0) / found->second;
    }
  }
  throw InvalidInput("FrequencyUnit is \"" + unit + "\"" +
                     (time_unit.empty() ? "" : " with TimeUnit \"" + time_unit + "\"") +
                     "; expected one such as rad/s, Hz, kHz, rpm or rad/minute");
}

class Reader {
 public:
  Reader(const MatFields& fields, const FrfOptions& options, FrfFile& file)
      : fields_(fields), options_(options), file_(file) {}

  void read() {
    read_frequencies();
    const auto* response = lookup_.find(kResponseNames);
    require(response != nullptr, "there are no responses; expected a variable H, G or frf" + had());
    require(response->kind == MatValue::Kind::number,
            "the responses are a " + response->class_name + ", expected numbers");
    read_names();
    const Layout layout = layout_of(*response);
    require_channels(layout.outputs, "outputs");
    require_channels(layout.inputs, "inputs");
    make_channels(layout);
    int parts = 0;
    for (const auto* part : {"variance", "var", "noise_variance", "noisevar", "coherence", "coh"}) {
      parts += mat_value(fields_, {part}) != nullptr ? 1 : 0;  // what is read in the end
    }
    require_room(file_.set, layout.lines, parts, options_.limit_bytes);
    require(response->imag.size() > 0,
            "the responses are real numbers, magnitudes or decibels without a phase; expected "
            "complex ones (where the imaginary parts are 0: H = complex(H))");
    file_.set.value.assign(static_cast<std::size_t>(layout.lines),
                           Eigen::MatrixXcd(layout.outputs, layout.inputs));
    each(layout, [&](Index k, Index i, Index j) {
      const Index at = layout.at(k, i, j);
      const std::complex<double> value(response->real(at), response->imag(at));
      require_measurable(value.real(), "a response", k, i, j);
      require_measurable(value.imag(), "a response", k, i, j);
      file_.set.value[static_cast<std::size_t>(k)](i, j) = value;
    });
    read_beside({"variance", "var"}, *response, layout, file_.set.variance);
    read_beside({"noise_variance", "noisevar"}, *response, layout, file_.set.noise_variance);
    read_beside({"coherence", "coh"}, *response, layout, file_.set.coherence);
    for (auto& line : file_.set.coherence) line = line.unaryExpr(&rounded_coherence);
    file_.set.averages = mat_number(lookup_.find({"averages"}), "averages").value_or(0.0);
    note_delays();
    note_rest();
  }

 private:
  void read_names() {
    output_names_ = mat_texts(lookup_.find({"output_names", "OutputName", "sensor_names", "sensors",
                                            "outputs", "y_names"}),
                              "output_names");
    input_names_ = mat_texts(lookup_.find({"input_names", "InputName", "actuator_names",
                                           "actuators", "inputs", "u_names"}),
                             "input_names");
  }

  // Notes the variables that are not read.
  void note_rest() {
    std::set<std::string> others{
        "output_unit", "OutputUnit", "output_node", "output_direction", "output_position",
        "input_unit",  "InputUnit",  "input_node",  "input_direction",  "input_position",
        "kind",        "InputDelay", "OutputDelay", "IODelay"};
    if (says_dimensions()) others.insert("dimensions");
    if (is_frd_)
      others.insert(
          {"InputGroup", "OutputGroup", "Ts", "Notes", "UserData", "Name", "SamplingGrid"});
    lookup_.note_rest(others, file_.notes);
  }

  [[nodiscard]] std::string had() const {
    std::string names;
    for (const auto& [name, value] : fields_) names += (names.empty() ? "" : ", ") + name;
    return "; there are: " + (names.empty() ? "none" : names);
  }

  void read_frequencies() {
    const auto* value = lookup_.find(kFrequencyNames);
    bool per_second = value != nullptr && value == mat_value(fields_, {"omega", "w"});
    require(value != nullptr, "there are no frequencies; expected a variable freq_hz" + had());
    file_.set.frequency_hz = mat_numbers(value, "the frequencies");
    is_frd_ = mat_value(fields_, {"ResponseData"}) != nullptr;
    if (is_frd_) per_second = true;  // MATLAB's default
    const auto* stated =
        lookup_.find({"FrequencyUnit", "frequency_unit", "FreqUnit", "freq_unit", "f_unit"});
    if (stated == nullptr && is_frd_)
      stated = lookup_.find({"Units"});  // frd objects before R2012a
    const auto unit = mat_texts(stated, "FrequencyUnit");
    const auto time = mat_texts(lookup_.find({"TimeUnit"}), "TimeUnit");
    const bool is_stated = !unit.empty() && !unit.front().empty();
    const double hertz = is_stated    ? hz_of(unit.front(), time.empty() ? "" : time.front())
                            : per_second ? 1.0 / (2.0 * std::numbers::pi)
                                      : 1.0;
    const bool is_in_hertz =
        value == mat_value(fields_, {"freq_hz", "frequency_hz", "f_hz", "freqHz"});
    require(!is_stated || !is_in_hertz || hertz == 1.0,
            "the frequencies are in Hz by their name and in " +
                shown(is_stated ? unit.front() : "") + " by their unit");
    file_.set.frequency_hz *= hertz;
    const auto& f = file_.set.frequency_hz;
    require(f.size() > 0, "there are no frequencies: the vector is empty");
    for (Index k = 0; k < f.size(); ++k) {
      require(f(k) >= 0.0 && (k == 0 || f(k) > f(k - 1)),
              "frequency " + fmt::to_string(k + 1) + " is " + fmt::format("{:.9g}", f(k)) +
                  " Hz; expected ascending frequencies, 0 or more");
    }
  }

  [[nodiscard]] Layout layout_of(const MatValue& response) const {
    const Index k = file_.set.line_count();
    auto dims = response.dims;
    while (dims.size() > 3 && dims.back() == 1) dims.pop_back();
    const std::string found =
        "the responses are " + mat_size(response) + " for " + fmt::to_string(k) + " frequencies";
    require(dims.size() <= 3, found + ", expected lines x outputs x inputs");
    if (dims.size() == 2) return layout_of_two(dims, found);
    const bool first = dims[0] == k, last = dims[2] == k;
    require(first || last, found + "; expected " + fmt::to_string(k) + " lines first or last");
    const bool both = first && last;
    if (both ? lines_stand_first(dims, found) : first) {
      return {k, dims[1], dims[2], 1, k, k * dims[1]};
    }
    return {k, dims[0], dims[1], dims[0] * dims[1], 1, dims[0]};
  }

  // Whether the first of three dimensions is that of the lines, where the last one may be, too.
  [[nodiscard]] bool lines_stand_first(const std::vector<Index>& dims,
                                       const std::string& found) const {
    const bool by_names = fits(dims[1], dims[2]);
    if (says_dimensions()) return says_dimensions(kLinesFirst);
    const bool is_one_number = dims[0] * dims[1] == 1;
    require(is_one_number || by_names != fits(dims[0], dims[1]),
            found + ": lines may be first or last; give output_names and input_names, another " +
                "number of lines, or dimensions = \"" + kLinesLast + "\"");
    return by_names;
  }

  // Whether the file has a variable `dimensions` with this text. Programs may mean other things by
  // that name.
  [[nodiscard]] bool says_dimensions(std::string_view text) const {
    const auto* said = mat_value(fields_, {"dimensions"});
    return said != nullptr && said->kind == MatValue::Kind::text && said->text.size() == 1 &&
           said->text.front() == text;
  }
  [[nodiscard]] bool says_dimensions() const {
    return says_dimensions(kLinesFirst) || says_dimensions(kLinesLast);
  }

  // Whether these numbers of outputs and inputs agree with the given names.
  [[nodiscard]] bool fits(Index outputs, Index inputs) const {
    const auto agrees = [](const std::vector<std::string>& names, Index count) {
      return names.empty() || static_cast<Index>(names.size()) == count;
    };
    return agrees(output_names_, outputs) && agrees(input_names_, inputs);
  }

  // The layout of an array lines×n or n×lines: one input with n outputs, unless the names show
  // something else.
  [[nodiscard]] Layout layout_of_two(const std::vector<Index>& dims,
                                     const std::string& found) const {
    const Index k = file_.set.line_count();
    const bool first = dims[0] == k, last = dims[1] == k;
    require(first || last, found + "; expected " + fmt::to_string(k) + " lines first or last");
    require(!first || !last || k == 1, found +
                                           ": lines may be first or last; write it with three "
                                           "dimensions");
    const Index n = first ? dims[1] : dims[0];
    const Index along_lines = first ? 1 : n, along_channels = first ? k : 1;
    const bool as_inputs = !fits(n, 1) && fits(1, n);
    if (as_inputs) return {k, 1, n, along_lines, 0, along_channels};
    return {k, n, 1, along_lines, along_channels, 0};
  }

  template <typename Do>
  static void each(const Layout& layout, Do action) {
    for (Index k = 0; k < layout.lines; ++k) {
      for (Index j = 0; j < layout.inputs; ++j) {
        for (Index i = 0; i < layout.outputs; ++i) action(k, i, j);
      }
    }
  }

  static void require_measurable(double number, const std::string& what, Index k, Index i,
                                 Index j) {
    if (is_measurable(number)) return;
    throw InvalidInput(what + " on line " + fmt::to_string(k + 1) + " from input " +
                       fmt::to_string(j + 1) + " to output " + fmt::to_string(i + 1) + ": " +
                       not_measurable(number));
  }

  void read_beside(std::initializer_list<std::string_view> names, const MatValue& response,
                   const Layout& layout, std::vector<Eigen::MatrixXd>& of) {
    const auto* value = lookup_.find(names);
    if (value == nullptr) return;
    const std::string what(*names.begin());
    const auto numbers = mat_numbers(value, what);
    require(value->dims == response.dims, what + " is " + mat_size(*value) + ", expected " +
                                              mat_size(response) + " as the responses");
    of.assign(static_cast<std::size_t>(layout.lines),
              Eigen::MatrixXd(layout.outputs, layout.inputs));
    each(layout, [&](Index k, Index i, Index j) {
      const double number = numbers(layout.at(k, i, j));
      require_measurable(number, what, k, i, j);
      of[static_cast<std::size_t>(k)](i, j) = number;
    });
  }

  void make_channels(const Layout& layout) {
    const auto make = [&](std::vector<modal::MeasuredChannel>& side, Index count,
                          const std::vector<std::string>& names,
                          const std::vector<std::string>& known, const char* letter) {
      require(names.empty() || static_cast<Index>(names.size()) == count,
              fmt::to_string(names.size()) + " names for " + fmt::to_string(count) + " channels " +
                  letter);
      const bool unnamed =
          std::all_of(names.begin(), names.end(), [](const auto& name) { return name.empty(); });
      const bool take_known = unnamed && static_cast<Index>(known.size()) == count;
      for (Index c = 0; c < count; ++c) {
        const auto at = static_cast<std::size_t>(c);
        side.emplace_back().name = take_known ? known[at]
                                   : unnamed  ? letter + fmt::to_string(c + 1)
                                              : names[at];
      }
      if (unnamed) {
        file_.notes.push_back("the channels have no names: taken as " + side.front().name +
                              (count > 1 ? " to " + side.back().name : ""));
      }
    };
    make(file_.set.outputs, layout.outputs, output_names_, options_.sensor_names, "y");
    make(file_.set.inputs, layout.inputs, input_names_, options_.actuator_names, "u");
    describe_channels(fields_, "output", file_.set.outputs);
    describe_channels(fields_, "input", file_.set.inputs);
    if (!is_frd_ && state_one_unit(fields_, file_.set.outputs)) lookup_.find({"unit", "units"});
    const auto stated = read_kinds(fields_, file_.set.outputs);
    kinds_known_ = !stated.empty() && std::ranges::all_of(stated, std::identity());
    require(kinds_known_ || std::ranges::none_of(stated, std::identity()),
            "kind is stated of some outputs only; expected one word, or one per output");
  }

  void note_delays() {
    for (const char* name : {"InputDelay", "OutputDelay", "IODelay"}) {
      const auto* value = mat_value(fields_, {name});
      if (value == nullptr || value->kind != MatValue::Kind::number || value->real.size() == 0) {
        continue;
      }
      if (value->real.cwiseAbs().maxCoeff() > 0.0) {
        file_.notes.push_back(std::string(name) + " of the frd object is not applied");
      }
    }
  }

 public:
  [[nodiscard]] bool kinds_known() const { return kinds_known_; }

 private:
  const MatFields& fields_;
  const FrfOptions& options_;
  FrfFile& file_;
  std::vector<std::string> output_names_, input_names_;
  MatLookup lookup_{fields_};
  bool kinds_known_ = false, is_frd_ = false;
};

bool has_responses(const MatFields& fields) {
  return has_numbers(mat_value(fields, kResponseNames)) &&
         has_numbers(mat_value(fields, kFrequencyNames));
}

// The variables of the file, or the fields of the one structure with responses. Notes the
// variables beside that structure.
const MatFields& scope_of(const MatFile& file, std::vector<std::string>& notes) {
  if (has_responses(file.variables)) return file.variables;
  const MatValue* found = nullptr;
  std::string name;
  for (const auto& [variable, value] : file.variables) {
    if (value.kind != MatValue::Kind::structure || !has_responses(value.fields)) continue;
    require(found == nullptr, "both " + name + " and " + variable +
                                  " hold responses; expected one structure of them");
    found = &value;
    name = variable;
  }
  if (found != nullptr) {
    note_unread(file.variables, {found}, {}, notes);
    return found->fields;
  }
  for (const auto& [variable, value] : file.variables) {
    require(value.kind != MatValue::Kind::other,
            "the variable " + variable + " is of class " + value.class_name +
                ", which only MATLAB reads; save an frd object as struct(object)");
  }
  return file.variables;
}

// Reads the responses from variables.
void read_fields(const MatFields& fields, const FrfOptions& options, FrfFile& file) {
  Reader reader(fields, options, file);
  reader.read();
  bring_to_si(file, reader.kinds_known());
  for (const auto& output : file.set.outputs) note_unknown_output(output, file.notes);
  state_units(file, reader.kinds_known(), options);
  modal::check(file.set);
}

}  // namespace

FrfFile frf_of_mat(const MatFile& file, const std::string& name, const FrfOptions& options) {
  FrfFile result{.format = file.format, .set = {}, .notes = file.notes};
  try {
    const bool is_testlab = has_testlab_functions(file.variables);
    const auto& fields = is_testlab ? file.variables : scope_of(file, result.notes);
    if (is_testlab && !has_responses(fields)) {
      const auto functions = testlab_responses(fields, options, result.notes);
      if (!functions) throw NoResponses(name + ": functions, but no frequency responses");
      read_fields(*functions, options, result);
      return result;
    }
    if (!has_responses(fields) && mat_value(file.variables, {"y", "u"}) != nullptr) {
      throw NoResponses(name + ": recordings (y, u), no frequency responses");
    }
    read_fields(fields, options, result);
  } catch (const NoResponses&) {
    throw;
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what());
  }
  return result;
}

}  // namespace chladni::io
