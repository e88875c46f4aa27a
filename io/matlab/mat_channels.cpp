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

}  // namespace

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
  const auto units = mat_texts(mat_value(fields, {side + "_unit", matlab}), side + "_unit");
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
    if (!units.empty()) {
      channel.unit = units[std::min(static_cast<std::size_t>(c), units.size() - 1)];
    }
    if (nodes.size() > 0 && std::abs(nodes(c)) < 1e15) {
      channel.node = static_cast<long long>(nodes(c));
    }
    for (Index axis = 0; axis < 3 && along.size() > 0; ++axis) {
      channel.direction(axis) = along(c + count * axis);
    }
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
  const auto words = mat_texts(mat_value(fields, {"kind"}), "kind");
  std::vector<bool> stated(outputs.size(), false);
  for (std::size_t i = 0; i < outputs.size() && !words.empty(); ++i) {
    const auto& word = words[std::min(i, words.size() - 1)];
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
