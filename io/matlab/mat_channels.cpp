#include "io/matlab/mat_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "io/matlab/mat_names.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

constexpr std::array<const char*, 3> kResponses{"receptance", "mobility", "accelerance"};
constexpr std::array<const char*, 3> kMotions{"displacement", "velocity", "acceleration"};

// One text for each channel; a single one is that of all. Empty where the value is null.
std::vector<std::string> one_or_each(const MatValue* value, const std::string& what, Index count) {
  auto texts = mat_texts(value, what);
  require(texts.size() < 2 || std::ssize(texts) == count,
          fmt::format("{} has {} texts, expected one, or one for each of {} channels", what,
                      texts.size(), count));
  if (texts.size() == 1) texts.resize(static_cast<std::size_t>(count), texts.front());
  return texts;
}

// Whether it is what mat_texts reads.
bool holds_texts(const MatValue& value) {
  const auto is_text = [](const MatValue& cell) {
    return cell.size() == 0 || (cell.kind == MatValue::Kind::text && cell.text.size() == 1);
  };
  return value.kind == MatValue::Kind::text ||
         (value.kind == MatValue::Kind::cell && std::ranges::all_of(value.cells, is_text));
}

}  // namespace

bool state_one_unit(const MatFields& fields, std::vector<modal::MeasuredChannel>& outputs) {
  const auto* value = mat_value(fields, {"unit", "units"});
  const auto is_there = [](const auto& output) { return !output.unit.empty(); };
  if (value == nullptr || !holds_texts(*value) || std::ranges::any_of(outputs, is_there)) {
    return false;
  }
  const auto units = one_or_each(value, "unit", std::ssize(outputs));
  for (const auto& unit : units) {
    require(!factor_of(unit, "Hz") && !factor_of(unit, "s"),
            "unit is " + shown(unit) + ", expected that of the outputs");
  }
  for (std::size_t i = 0; i < units.size(); ++i) outputs[i].unit = units[i];
  return true;
}

void add_channels(MatFields& fields, const std::string& side,
                  const std::vector<modal::MeasuredChannel>& channels) {
  const auto count = static_cast<Index>(channels.size());
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> names, units;
  Eigen::MatrixXd node = Eigen::MatrixXd::Constant(count, 1, nothing);
  Eigen::MatrixXd direction(count, 3);
  Eigen::MatrixXd position = Eigen::MatrixXd::Constant(count, 3, nothing);
  bool any_unit = false;
  for (Index c = 0; c < count; ++c) {
    const auto& channel = channels[static_cast<std::size_t>(c)];
    names.push_back(channel.name);
    units.push_back(channel.unit);
    any_unit = any_unit || !channel.unit.empty();
    if (channel.node) node(c) = static_cast<double>(*channel.node);
    direction.row(c) = channel.direction.transpose();
    if (channel.position) position.row(c) = channel.position->transpose();
  }
  fields.emplace_back(side + "_names", names);
  if (any_unit) fields.emplace_back(side + "_unit", units);
  if (!node.array().isNaN().all()) fields.emplace_back(side + "_node", node);
  if (direction.any()) fields.emplace_back(side + "_direction", direction);
  if (!position.array().isNaN().all()) fields.emplace_back(side + "_position", position);
}

void describe_channels(const MatFields& fields, const std::string& side,
                       std::vector<modal::MeasuredChannel>& channels) {
  const auto count = static_cast<Index>(channels.size());
  const std::string matlab = side == "output"  ? "OutputUnit"
                             : side == "input" ? "InputUnit"
                                               : side + "_unit";
  const auto units =
      one_or_each(mat_value(fields, {side + "_unit", matlab}), side + "_unit", count);
  const auto nodes = mat_numbers(mat_value(fields, {side + "_node"}), side + "_node");
  const auto along = mat_numbers(mat_value(fields, {side + "_direction"}), side + "_direction");
  const auto place = mat_numbers(mat_value(fields, {side + "_position"}), side + "_position");
  for (const auto& [numbers, each] : {std::pair(&nodes, 1), {&along, 3}, {&place, 3}}) {
    require(numbers->size() == 0 || numbers->size() == each * count,
            side + "_node, _direction or _position: " + fmt::to_string(numbers->size()) +
                " numbers, expected " + fmt::to_string(each) + " per channel");
  }
  for (Index c = 0; c < count; ++c) {
    auto& channel = channels[static_cast<std::size_t>(c)];
    if (!units.empty()) channel.unit = units[static_cast<std::size_t>(c)];
    if (nodes.size() > 0 && std::abs(nodes(c)) < 1e15) {
      require(nodes(c) == std::floor(nodes(c)),
              fmt::format("{}_node is {:g}, expected whole numbers", side, nodes(c)));
      channel.node = static_cast<long long>(nodes(c));
    }
    for (Index axis = 0; axis < 3 && along.size() > 0; ++axis) {
      channel.direction(axis) = along(c + count * axis);
    }
    if (!channel.direction.allFinite()) channel.direction.setZero();
    const double length = channel.direction.norm();
    require(length == 0.0 || std::abs(length - 1.0) < 1e-3,
            fmt::format("{}_direction of {} has the length {:g}, expected 1, or 0 where it is not "
                        "known",
                        side, channel.name, length));
    if (place.size() == 0) continue;
    const Eigen::Vector3d at(place(c), place(c + count), place(c + 2 * count));
    if (at.allFinite()) channel.position = at;
  }
}

void add_kinds(MatFields& fields, const std::vector<modal::MeasuredChannel>& outputs) {
  std::vector<std::string> kinds;
  bool any = false;
  for (const auto& output : outputs) {
    const bool told = motion_unit(output.unit).has_value();
    const bool known = told || output.kind != modal::FrfKind::receptance;
    any = any || (known && !told);
    kinds.emplace_back(known ? kMotions[static_cast<std::size_t>(output.kind)] : "");
  }
  if (any) fields.emplace_back("kind", kinds);
}

std::vector<bool> read_kinds(const MatFields& fields,
                             std::vector<modal::MeasuredChannel>& outputs) {
  const auto words = one_or_each(mat_value(fields, {"kind"}), "kind", std::ssize(outputs));
  std::vector<bool> stated(outputs.size(), false);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& word = words[i];
    if (word.empty()) continue;
    for (std::size_t k = 0; k < kResponses.size(); ++k) {
      if (word != kResponses[k] && word != kMotions[k]) continue;
      outputs[i].kind = static_cast<modal::FrfKind>(k);
      stated[i] = true;
    }
    require(stated[i], "kind is " + shown(word) +
                           ", expected receptance, mobility or accelerance, of recordings "
                           "displacement, velocity or acceleration");
  }
  return stated;
}

}  // namespace chladni::io
