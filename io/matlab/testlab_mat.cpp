#include "io/matlab/testlab_mat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/error.h"
#include "io/bytes/room.h"
#include "io/matlab/testlab_function.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;
using Functions = std::vector<TestlabFunction>;

bool contains_function(const MatValue& value) {
  const auto inner = [](const auto& field) { return contains_function(field.second); };
  return is_testlab_function(value) || std::ranges::any_of(value.cells, &contains_function) ||
         std::ranges::any_of(value.fields, inner);
}

// The functions of these kinds. Notes those of others.
Functions chosen_functions(Functions functions, std::initializer_list<TestlabKind> kinds,
                           std::vector<std::string>& notes) {
  Functions found;
  std::vector<std::string> others;
  for (auto& one : functions) {
    if (std::ranges::find(kinds, one.kind) != kinds.end()) {
      found.push_back(std::move(one));
    } else {
      others.push_back(one.name + (one.type.empty() ? "" : " (" + one.type + ")"));
    }
  }
  if (!found.empty() && !others.empty()) {
    notes.push_back((others.size() > 1 ? "the functions " : "the function ") + listed(others) +
                    (others.size() > 1 ? " are not read" : " is not read"));
  }
  return found;
}

void require_same_x(const TestlabFunction& one, const TestlabFunction& first, const char* unit) {
  const auto said = [&](const TestlabFunction& f) {
    return fmt::format("{} has {} values from {:g} to {:g} {}", f.name, f.x.size(), f.x(0),
                       f.x(f.x.size() - 1), unit);
  };
  const bool is_same = one.x.size() == first.x.size() && (one.x - first.x).cwiseAbs().maxCoeff() <=
                                                             1e-9 * first.x.cwiseAbs().maxCoeff();
  require(is_same, said(one) + ", " + said(first) + "; expected the same of all");
}

// The place of a name in a list, to which a new one is added.
std::size_t place_in(const std::string& name, std::vector<std::string>& names) {
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

// Names the channels that a function does not name, as the one of the study or by the variable.
void name_unnamed(Functions& functions, const FrfOptions& options,
                  std::vector<std::string>& notes) {
  for (auto& one : functions) {
    if (!one.output.empty() && !one.input.empty()) continue;
    const bool is_only = functions.size() == 1 && options.sensor_names.size() == 1;
    if (one.output.empty()) one.output = is_only ? options.sensor_names.front() : one.name;
    if (one.input.empty()) {
      one.input = options.actuator_names.size() == 1 ? options.actuator_names.front() : "u1";
    }
    notes.push_back("the function " + one.name + " does not name both of its channels: taken as " +
                    one.output + " over " + one.input);
  }
}

/// The arrays of responses and coherences.
struct Arrays {
  std::vector<std::string> outputs, inputs, units;
  std::map<std::pair<std::size_t, std::size_t>, const TestlabFunction*> response, coherence;
};

void add_unit(const TestlabFunction& one, std::size_t output, Arrays& arrays) {
  if (output == arrays.units.size()) arrays.units.push_back(one.unit);
  require(arrays.units[output] == one.unit, one.name + " is in " + shown(one.unit) +
                                                ", others of " + one.output + " are in " +
                                                shown(arrays.units[output]));
}

Arrays arrays_of(const Functions& functions) {
  Arrays arrays;
  for (const bool is_coherence : {false, true}) {
    for (const auto& one : functions) {
      if ((one.kind == TestlabKind::coherence) != is_coherence) continue;
      require_same_x(one, functions.front(), "Hz");
      const std::pair pair(place_in(one.output, arrays.outputs),
                           place_in(one.input, arrays.inputs));
      require(!is_coherence || arrays.response.contains(pair),
              one.name + " is the coherence of " + one.output + " over " + one.input +
                  ", of which there is no response");
      auto& of = is_coherence ? arrays.coherence : arrays.response;
      const auto [place, is_new] = of.emplace(pair, &one);
      require(is_new, one.name + " and " + place->second->name + " are both of " + one.output +
                          " over " + one.input);
      if (!is_coherence) add_unit(one, pair.first, arrays);
    }
  }
  return arrays;
}

// Pairs that are not among the functions take room, too.
void require_testlab_room(const Arrays& arrays, Index lines, std::size_t limit) {
  const auto p = std::ssize(arrays.outputs);
  const auto q = std::ssize(arrays.inputs);
  require_channels(p, "outputs");
  require_channels(q, "inputs");
  const double each = arrays.coherence.empty() ? 16.0 : 24.0;  // bytes
  require_room(each * static_cast<double>(lines) * static_cast<double>(p) * static_cast<double>(q),
               limit, fmt::format("{} outputs by {} inputs on {} lines", p, q, lines));
}

MatValue testlab_array(
    const std::map<std::pair<std::size_t, std::size_t>, const TestlabFunction*>& of,
    const Arrays& arrays, Index lines, bool is_complex) {
  const auto p = std::ssize(arrays.outputs);
  const auto q = std::ssize(arrays.inputs);
  Eigen::VectorXd real =
      Eigen::VectorXd::Constant(lines * p * q, std::numeric_limits<double>::quiet_NaN());
  Eigen::VectorXd imag = is_complex ? real : Eigen::VectorXd();
  for (const auto& [pair, function] : of) {
    const auto column = static_cast<Index>(pair.first) + p * static_cast<Index>(pair.second);
    real.segment(lines * column, lines) = function->values.real();
    if (is_complex) imag.segment(lines * column, lines) = function->values.imag();
  }
  return {{lines, p, q}, std::move(real), std::move(imag)};
}

void require_kind_told(const TestlabFunction& one, const FrfOptions& options) {
  const bool is_ratio = one.unit.find('/') != std::string::npos && is_response_unit(one.unit);
  require(!one.type.empty() || is_ratio || !options.unit.empty(),
          "the function " + one.name + ": neither function_record.type nor the unit " +
              shown(one.unit) + " tells what it is; expected the type FRF");
}

}  // namespace

bool has_testlab_functions(const MatFields& variables) {
  return std::ranges::any_of(variables,
                             [](const auto& one) { return contains_function(one.second); });
}

std::optional<MatFields> testlab_responses(const MatFields& variables, const FrfOptions& options,
                                           std::vector<std::string>& notes) {
  auto functions = chosen_functions(testlab_functions(variables, options.unit),
                                    {TestlabKind::response, TestlabKind::coherence}, notes);
  const auto is_response = [](const auto& one) { return one.kind == TestlabKind::response; };
  if (std::ranges::none_of(functions, is_response)) return std::nullopt;
  for (const auto& one : functions) {
    if (is_response(one)) require_kind_told(one, options);
  }
  name_unnamed(functions, options, notes);
  const auto arrays = arrays_of(functions);
  const Index lines = functions.front().x.size();
  require_testlab_room(arrays, lines, options.limit_bytes);
  MatFields fields{{"freq_hz", Eigen::MatrixXd(functions.front().x)},
                   {"H", testlab_array(arrays.response, arrays, lines, true)},
                   {"output_names", arrays.outputs},
                   {"input_names", arrays.inputs},
                   {"output_unit", arrays.units}};
  if (!arrays.coherence.empty()) {
    fields.emplace_back("coherence", testlab_array(arrays.coherence, arrays, lines, false));
  }
  return fields;
}

namespace {

/// The channels of one side of a recording.
struct RecordedSide {
  std::vector<std::string> names, units;
  std::vector<const TestlabFunction*> columns;
};

// The unit that the user states is that of outputs: of what stands beside a transformation of
// another kind of unit it tells nothing. kEachInSi tells it of all.
std::string told_unit(const TestlabFunction& one, Side side, const std::string& unit) {
  if (!one.is_transformed) return one.unit;
  const auto label = motion_unit(one.label);
  if (unit == kEachInSi) return label ? label->si : force_unit(one.label) ? "N" : "";
  const auto stated = motion_unit(bare_unit(unit));
  const bool is_of_kind = label && stated && label->kind == stated->kind;
  const bool is_told = side == Side::output &&
                       (is_of_kind || bare_unit(unit) == one.label || !is_measured_unit(one.label));
  require(is_told, one.name + " has the label " + shown(one.label) +
                       " and a unit_transformation: whether its values are in the unit of the "
                       "label or in SI is not told by the unit " +
                       shown(unit) +
                       "; expected a file without transformations, or unit = \"SI\" where the "
                       "values of all channels are in SI");
  return one.unit;
}

// Adds the channel to the outputs or to the inputs.
void add_channel(const TestlabFunction& one, const std::string& channel, const TimeOptions& options,
                 RecordedSide& outputs, RecordedSide& inputs) {
  const auto [side, name] = side_of(channel, one.label, options);
  require(side != Side::reference,
          one.name + " is of the reference " + channel + "; expected outputs and inputs");
  auto& of = side == Side::input ? inputs : outputs;
  const auto before = of.names.size();
  require(place_in(name, of.names) == before,
          one.name + " is a second function of the channel " + name + "; expected one recording");
  of.units.push_back(told_unit(one, side, options.unit));
  of.columns.push_back(&one);
}

void add_side(const RecordedSide& side, const char* variable, const std::string& key,
              MatFields& fields) {
  if (side.columns.empty()) return;
  Eigen::MatrixXd samples(side.columns.front()->x.size(), std::ssize(side.columns));
  for (Index c = 0; c < samples.cols(); ++c) {
    samples.col(c) = side.columns[static_cast<std::size_t>(c)]->values.real();
  }
  fields.emplace_back(variable, samples);
  fields.emplace_back(key + "_names", side.names);
  fields.emplace_back(key + "_unit", side.units);
}

}  // namespace

std::optional<MatFields> testlab_recordings(const MatFields& variables, const TimeOptions& options,
                                            std::vector<std::string>& notes) {
  const auto functions =
      chosen_functions(testlab_functions(variables, options.unit), {TestlabKind::recording}, notes);
  if (functions.empty()) return std::nullopt;
  RecordedSide outputs, inputs;
  for (const auto& one : functions) {
    require_same_x(one, functions.front(), "s");
    if (one.output.empty()) notes.push_back("the function " + one.name + " names no channel");
    add_channel(one, one.output.empty() ? one.name : one.output, options, outputs, inputs);
  }
  const auto& first = functions.front();
  MatFields fields;
  if (first.step > 0.0)
    fields.emplace_back("sample_time_s", first.step);
  else
    fields.emplace_back("time_s", Eigen::MatrixXd(first.x));
  add_side(outputs, "y", "output", fields);
  add_side(inputs, "u", "input", fields);
  return fields;
}

}  // namespace chladni::io
