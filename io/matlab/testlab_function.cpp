#include "io/matlab/testlab_function.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "io/matlab/mat_names.h"
#include "io/measured/frf_units.h"
#include "io/measured/measurable.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

const MatValue* structure_in(const MatFields& fields, std::initializer_list<std::string_view> of) {
  const auto* value = mat_value(fields, of);
  return value != nullptr && value->kind == MatValue::Kind::structure ? value : nullptr;
}

// A text, or the name of a structure with its direction: "wing:1" with "+Z".
std::string text_in(const MatValue* value) {
  if (value == nullptr) return "";
  if (value->kind == MatValue::Kind::text && value->text.size() == 1) {
    return std::string(trimmed(value->text.front()));
  }
  if (value->kind == MatValue::Kind::cell && value->cells.size() == 1) {
    return text_in(&value->cells.front());
  }
  if (value->kind != MatValue::Kind::structure) return "";
  const auto& fields = value->fields;
  const auto name = text_in(mat_value(fields, {"name", "point_id", "point", "id", "label"}));
  const auto direction = text_in(mat_value(fields, {"direction", "dir"}));
  return name.empty() || direction.empty() ? name : name + ":" + direction;
}

// The number in a field; none where it is missing or empty.
std::optional<double> number_in_field(const MatFields& fields, std::string_view name) {
  const auto number = mat_number(mat_value(fields, {name}), name);
  require(!number || std::isfinite(*number), std::string(name) + " is no number; expected one");
  return number;
}

/// What `quantity` says of an axis.
struct Quantity {
  std::string label;
  double factor = 1.0, offset = 0.0;  ///< of unit_transformation

  [[nodiscard]] bool transforms() const { return factor != 1.0 || offset != 0.0; }
};

Quantity quantity_in(const MatFields& axis) {
  Quantity found;
  const auto* quantity = structure_in(axis, {"quantity"});
  if (quantity == nullptr) return found;
  found.label = text_in(mat_value(quantity->fields, {"label"}));
  const auto* transformation = structure_in(quantity->fields, {"unit_transformation"});
  if (transformation == nullptr) return found;
  found.factor = number_in_field(transformation->fields, "factor").value_or(1.0);
  found.offset = number_in_field(transformation->fields, "offset").value_or(0.0);
  return found;
}

// Whether values over an abscissa with this label may be read; one without a label may be.
bool is_abscissa(const std::string& label) {
  const auto unit = bare_unit(label);
  return unit.empty() || factor_of(unit, "s") || factor_of(unit, "Hz") || factor_of(unit, "rad/s");
}

// Whether x is a time, and its unit in s or Hz.
std::pair<bool, double> unit_of_x(const Quantity& quantity, bool is_recording) {
  require(!quantity.transforms(),
          fmt::format("x_values has the label {} and a unit_transformation of factor {:g} and "
                      "offset {:g}; expected none",
                      shown(quantity.label), quantity.factor, quantity.offset));
  if (quantity.label.empty()) return {is_recording, 1.0};
  const auto unit = bare_unit(quantity.label);
  if (const auto seconds = factor_of(unit, "s")) return {true, *seconds};
  if (const auto hertz = factor_of(unit, "Hz")) return {false, *hertz};
  const auto angular = factor_of(unit, "rad/s");
  require(angular.has_value(), "x_values is in " + shown(quantity.label) + ", expected Hz or s");
  return {false, *angular / (2.0 * std::numbers::pi)};
}

// The abscissa in the unit of the file.
void read_x(const MatFields& axis, Index lines, TestlabFunction& function) {
  const auto count = number_in_field(axis, "number_of_values");
  require(!count || *count == static_cast<double>(lines),
          fmt::format("x_values has number_of_values {:g}, y_values {} values", count.value_or(0.0),
                      lines));
  const auto stated = mat_numbers(mat_value(axis, {"values"}), "x_values.values");
  if (stated.size() > 0) {
    require(stated.size() == lines,
            fmt::format("x_values has {} values, y_values {}", stated.size(), lines));
    function.x = stated;
    return;
  }
  const auto start = number_in_field(axis, "start_value");
  const auto step = number_in_field(axis, "increment");
  require(start && step && *step > 0.0,
          "x_values has no start_value with an increment above 0, and no values either");
  function.step = *step;
  function.x.resize(lines);
  for (Index k = 0; k < lines; ++k) function.x(k) = *start + *step * static_cast<double>(k);
}

TestlabKind testlab_kind(const std::string& stated, bool is_time, bool is_complex) {
  const auto type = upper(stated);
  const auto says = [&](std::string_view word) { return type.find(word) != std::string::npos; };
  if (is_time) {
    const bool is_signal = type.empty() || says("SIGNAL") || says("TIME") || says("THROUGHPUT");
    return is_signal && !is_complex ? TestlabKind::recording : TestlabKind::other;
  }
  if (says("COHERENCE")) {
    const bool is_of_pair = !says("MULTIPLE") && !says("PARTIAL") && !is_complex;
    return is_of_pair ? TestlabKind::coherence : TestlabKind::other;
  }
  const bool is_response = type.empty() ? is_complex
                                        : type == "FRF" || says("FREQUENCY RESPONSE") ||
                                              type.starts_with("FRF ") || says("TRANSFER FUNCTION");
  return is_response ? TestlabKind::response : TestlabKind::other;
}

// Whether a function of this type is read; of the empty one that is so.
bool is_read_type(const std::string& type) {
  return testlab_kind(type, true, false) != TestlabKind::other ||
         testlab_kind(type, false, true) != TestlabKind::other ||
         testlab_kind(type, false, false) != TestlabKind::other;
}

/// Reads one structure, which may hold several columns of values.
class FunctionReader {
 public:
  FunctionReader(const MatFields& fields, std::string name, const std::string& unit)
      : x_(structure_in(fields, {"x_values"})->fields),
        y_(structure_in(fields, {"y_values"})->fields),
        unit_(unit) {
    function_.name = std::move(name);
    static const MatFields none;
    const auto* record = structure_in(fields, {"function_record"});
    record_ = record == nullptr ? &none : &record->fields;
  }

  std::vector<TestlabFunction> read() {
    function_.type = text_in(mat_value(*record_, {"type", "function_type"}));
    if (!is_read_type(function_.type)) return {function_};
    const auto of_x = quantity_in(x_);
    if (function_.type.empty() && !is_abscissa(of_x.label)) return {function_};
    const auto* values = mat_value(y_, {"values"});
    require(values != nullptr && values->kind == MatValue::Kind::number && values->size() > 0 &&
                values->dims.size() == 2,
            values == nullptr ? "y_values has no values"
                              : "y_values.values is a " + values->class_name + " of " +
                                    mat_size(*values) + ", expected numbers");
    const bool is_complex = values->imag.size() > 0;
    const bool may_be_recording =
        testlab_kind(function_.type, true, is_complex) != TestlabKind::other;
    if (!may_be_recording &&
        testlab_kind(function_.type, false, is_complex) == TestlabKind::other) {
      return {function_};
    }
    const Index lines = values->dims[0] == 1 ? values->dims[1] : values->dims[0];
    const Index columns = values->size() / lines;
    require(columns <= lines, "y_values.values is " + mat_size(*values) + ", expected a column");
    read_x(x_, lines, function_);
    const auto [is_time, factor] = unit_of_x(of_x, may_be_recording);
    function_.x *= factor;
    function_.step *= factor;
    function_.kind = testlab_kind(function_.type, is_time, is_complex);
    if (function_.kind == TestlabKind::other) return {function_};
    require(function_.kind != TestlabKind::response || is_complex,
            "y_values.values are real numbers, without a phase; expected complex ones");
    read_unit();
    return with_columns(*values, lines, columns);
  }

 private:
  // The unit of the values. Where the label has a transformation it is not told which of the two
  // units they are in.
  void read_unit() {
    const auto quantity = quantity_in(y_);
    function_.label = bare_unit(quantity.label);
    function_.is_transformed = quantity.transforms();
    if (!quantity.transforms() || function_.kind == TestlabKind::coherence) {
      function_.unit = function_.label;
      return;
    }
    require(!unit_.empty(),
            fmt::format("y_values has the label {} and a unit_transformation of factor {:g} and "
                        "offset {:g}: whether its values are in the unit of the label or in SI is "
                        "not told; state the unit they are in, such as unit = \"{}\"",
                        shown(quantity.label), quantity.factor, quantity.offset,
                        function_.kind == TestlabKind::recording ? "g" : "g/N"));
  }

  // The names of the columns; one without a stroke for each.
  [[nodiscard]] std::vector<std::string> titles(Index columns) const {
    const auto* name = mat_value(*record_, {"name"});
    if (name == nullptr) return {};
    std::vector<std::string> found;
    if (name->kind == MatValue::Kind::cell || name->kind == MatValue::Kind::text) {
      found = mat_texts(name, "function_record.name");
    }
    require(found.empty() || std::ssize(found) == columns,
            fmt::format("function_record.name has {} names for {} columns of values", found.size(),
                        columns));
    return found;
  }

  [[nodiscard]] std::vector<TestlabFunction> with_columns(const MatValue& values, Index lines,
                                                          Index columns) const {
    const auto names = titles(columns);
    std::vector<TestlabFunction> found;
    for (Index c = 0; c < columns; ++c) {
      auto& one = found.emplace_back(function_);
      if (columns > 1) one.name += fmt::format(" column {}", c + 1);
      name_channels(names.empty() ? "" : names[static_cast<std::size_t>(c)], columns, one);
      one.values.resize(lines);
      for (Index k = 0; k < lines; ++k) {
        const Index at = c * lines + k;
        one.values(k) = {values.real(at), values.imag.size() > 0 ? values.imag(at) : 0.0};
        for (const double part : {one.values(k).real(), one.values(k).imag()}) {
          require(is_measurable(part) && std::isfinite(part),
                  fmt::format("value {} of y_values: {}", k + 1, not_measurable(part)));
        }
      }
    }
    return found;
  }

  void name_channels(std::string title, Index columns, TestlabFunction& one) const {
    if (columns == 1) {
      one.output = text_in(mat_value(*record_, {"primary_channel", "response_channel", "response",
                                                "output_channel", "output", "point_id", "point"}));
      one.input = text_in(mat_value(*record_, {"reference_channel", "reference", "input_channel",
                                               "input", "reference_id", "reference_point"}));
    }
    if (!one.type.empty() && title.starts_with(one.type + " ")) title.erase(0, one.type.size() + 1);
    const auto stroke = title.find('/');
    const bool is_pair = stroke != std::string::npos && title.find('/', stroke + 1) == title.npos;
    const bool is_recording = one.kind == TestlabKind::recording;
    if (is_pair && !is_recording) {
      if (one.output.empty()) one.output = trimmed(std::string_view(title).substr(0, stroke));
      if (one.input.empty()) one.input = trimmed(std::string_view(title).substr(stroke + 1));
    } else if (is_recording && one.output.empty()) {
      one.output = trimmed(title);
    }
  }

  const MatFields& x_;
  const MatFields& y_;
  const std::string& unit_;
  const MatFields* record_;
  TestlabFunction function_;
};

void gather_functions(const std::string& name, const MatValue& value, const std::string& unit,
                      std::vector<TestlabFunction>& found) {
  if (is_testlab_function(value)) {
    try {
      for (auto& one : FunctionReader(value.fields, name, unit).read()) {
        found.push_back(std::move(one));
      }
    } catch (const InvalidInput& refused) {
      throw InvalidInput("the function " + name + ": " + refused.what());
    }
    return;
  }
  const bool is_array =
      value.kind == MatValue::Kind::cell || value.kind == MatValue::Kind::structures;
  for (std::size_t c = 0; c < value.cells.size() && is_array; ++c) {
    gather_functions(name + "(" + fmt::to_string(c + 1) + ")", value.cells[c], unit, found);
  }
  for (const auto& [field, inner] : value.fields)
    gather_functions(name + "." + field, inner, unit, found);
}

}  // namespace

bool is_testlab_function(const MatValue& value) {
  return value.kind == MatValue::Kind::structure &&
         structure_in(value.fields, {"x_values"}) != nullptr &&
         structure_in(value.fields, {"y_values"}) != nullptr;
}

std::vector<TestlabFunction> testlab_functions(const MatFields& variables,
                                               const std::string& unit) {
  std::vector<TestlabFunction> found;
  for (const auto& [name, value] : variables) gather_functions(name, value, unit, found);
  return found;
}

}  // namespace chladni::io
