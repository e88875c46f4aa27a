#include "steps/extend/extension.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"

namespace chladni::steps {
namespace {

// The number at the start of a quantity's text, and the rest: " mm".
struct Written {
  double number = 0.0;
  std::string unit;
};

Written parts(const study::TomlNode& value) {
  if (value.is_number()) return {value.number, ""};
  std::string_view text = value.text;
  const bool plus = text.starts_with('+');
  if (plus) text.remove_prefix(1);
  Written result;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), result.number);
  require(fault == std::errc(),
          fmt::format("line {}: \"{}\" does not begin with a number", value.line, value.text));
  result.unit = std::string(text.substr(static_cast<std::size_t>(end - text.data())));
  return result;
}

std::string with_unit(const study::TomlNode& value, const Written& parts) {
  const std::string number = digits(parts.number);
  return value.is_number() ? number : study::toml_text(number + parts.unit);
}

const diagnosis::CauseParameter* find(const diagnosis::Cause& cause, std::string_view name) {
  for (const auto* numbers : {&cause.parameters, &cause.fixed}) {
    const auto found = std::ranges::find(*numbers, name, &diagnosis::CauseParameter::name);
    if (found != numbers->end()) return &*found;
  }
  return nullptr;
}

}  // namespace

double Extension::number(std::string_view name) const {
  const auto* found = find(cause, name);
  require(found != nullptr, fmt::format("the cause {} has no number \"{}\"", cause.effect, name));
  return found->value;
}

bool Extension::has(std::string_view name) const { return find(cause, name) != nullptr; }

std::string Extension::comment(std::string_view before) const {
  std::string numbers = cause.option;
  for (const auto& one : cause.parameters) {
    numbers += fmt::format("{}{} = {:.4g} \u00b1 {:.2g}{}", numbers.empty() ? "" : ", ", one.name,
                           one.value, one.std, one.unit == "1" ? "" : " " + one.unit);
  }
  std::string channels;
  for (const auto& one : cause.channels) channels += (channels.empty() ? " of " : ", ") + one;
  const std::string said =
      fmt::format("diagnosis: {}{}{}{}; probability {:.3g}", cause.effect, channels,
                  numbers.empty() ? "" : ": ", numbers, cause.probability);
  return before.empty() ? said : fmt::format("{}; before: {}", said, before);
}

std::string digits(double number) { return fmt::format("{:.9g}", number); }

void scale(const Extension& by, const study::TomlNode& value, double factor) {
  if (value.kind == study::TomlNode::Kind::array) {
    for (const auto& one : value.elements) scale(by, one, factor);
    return;
  }
  if (const auto* stated = study::member(value, "value")) {  // beside how well it is known
    scale(by, *stated, factor);
    return;
  }
  auto scaled = parts(value);
  scaled.number *= factor;
  by.edit.replace(value, with_unit(value, scaled), by.comment(by.edit.written(value)));
}

void lengthen(const Extension& by, const study::TomlNode& value, double metres) {
  auto moved = parts(value);
  const auto unit = moved.unit.find_first_not_of(' ');
  require(unit != std::string::npos,
          fmt::format("line {}: \"{}\" has no unit of length", value.line, value.text));
  moved.number += metres / unit_factor(moved.unit.substr(unit), "m");
  by.edit.replace(value, with_unit(value, moved), by.comment(by.edit.written(value)));
}

bool looks_down(const Extension& by) {
  return by.chart.axis_u == Eigen::Vector3d::UnitX() && by.chart.axis_v == Eigen::Vector3d::UnitY();
}

std::string place(const Extension& by) {
  const Eigen::Vector2d at(by.number("u"), by.number("v"));
  Eigen::Vector3d point = by.chart.in_body(at);
  if (!looks_down(by) && by.on.height) {
    point += by.on.height(at).value_or(0.0) * by.chart.axis_u.cross(by.chart.axis_v);
  }
  point.head<2>() *= 1.0 + by.growth;  // bodies that grow have their middle at the origin
  return place(study::Place{point, looks_down(by)});
}

std::string place(const study::Place& at) {
  const auto mm = [](double metres) {
    return study::toml_text(digits(std::abs(metres) < 1e-9 ? 0.0 : 1e3 * metres) + " mm");
  };
  const auto& p = at.point;
  if (at.from_above) return fmt::format("[{}, {}]", mm(p(0)), mm(p(1)));
  return fmt::format("[{}, {}, {}]", mm(p(0)), mm(p(1)), mm(p(2)));
}

Extend extend(std::string_view effect) {
  for (const auto part : {extend_body, extend_channels, extend_attachments, extend_constants}) {
    if (const auto found = part(effect)) return found;
  }
  return extend_by_record;
}

}  // namespace chladni::steps
