#include "io/uff/uff_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/error.h"
#include "base/quantity.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;  // [rad]

std::string lower(std::string word) {
  for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return word;
}

// A label as a unit. Its columns may cut a bracket off, "(m/s^2": what is left alone is no bracket.
std::string unit_of(const std::string& label) {
  auto unit = bare_unit(label);
  const bool is_whole = std::ranges::count(unit, '(') == std::ranges::count(unit, ')') &&
                        unit.find_first_of("[]") == std::string::npos;
  if (!is_whole)
    std::erase_if(unit, [](char c) { return c == '(' || c == ')' || c == '[' || c == ']'; });
  return unit;
}

// The unit in a label: "(m/s^2)", "M/S2", "g's". In "m/s^2/N" only the part before the last slash
// counts; that of "m/(s^2 N)" is over a newton.
std::optional<MotionUnit> motion_of_label(const std::string& stated) {
  auto label = unit_of(stated);
  if (upper(label) == "G" || upper(label) == "G'S" || upper(label) == "GS") label = "g";
  if (auto unit = motion_unit(label)) return unit;
  if (auto unit = motion_unit(lower(label))) return unit;
  const auto stroke = label.rfind('/');
  if (stroke == std::string::npos || !force_unit(label.substr(stroke + 1))) {
    return unit_over_newton(label);
  }
  return motion_of_label(label.substr(0, stroke));
}

// The force in "g/lbf": N per its unit.
std::optional<double> force_beside_motion(const std::string& stated) {
  const auto label = unit_of(stated);
  const auto stroke = label.rfind('/');
  if (motion_unit(label) || motion_unit(lower(label))) return std::nullopt;
  const auto force =
      stroke == std::string::npos ? std::nullopt : force_unit(label.substr(stroke + 1));
  return force && motion_of_label(label.substr(0, stroke)) ? force : std::nullopt;
}

// Whether a label is a motion over a force in one word, "m/(s^2 kN)". Its factor is per newton.
bool is_over_newton(const std::string& stated) {
  const auto label = unit_of(stated);
  return !motion_unit(label) && !motion_unit(lower(label)) && !force_beside_motion(stated) &&
         unit_over_newton(label);
}

// @param has_164  its unit is taken
std::string not_known(const std::string& unit, bool has_164) {
  return "the unit " + shown(unit) + " is not known: " +
         (has_164 ? "that of dataset 164 is taken" : "values are as they stand");
}

std::optional<modal::FrfKind> kind_of(int type) {
  switch (type) {
    case 8:
      return modal::FrfKind::receptance;
    case 11:
      return modal::FrfKind::mobility;
    case 12:
      return modal::FrfKind::accelerance;
    default:
      return std::nullopt;
  }
}

// The kind that a label states where the type is left open.
std::optional<modal::FrfKind> kind_of(const std::string& label) {
  const std::string word = upper(label.substr(0, 5));
  if (word == "DISPL") return modal::FrfKind::receptance;
  if (word == "VELOC") return modal::FrfKind::mobility;
  if (word == "ACCEL") return modal::FrfKind::accelerance;
  return std::nullopt;
}

const char* si_of(modal::FrfKind kind) {
  constexpr const char* units[] = {"m", "m/s", "m/s^2"};
  return units[static_cast<std::size_t>(kind)];
}

bool is_rotation(const UffDof& dof) { return std::abs(dof.direction) > 3; }

const char* si_of_rotation(modal::FrfKind kind) {
  constexpr const char* units[] = {"rad", "rad/s", "rad/s^2"};
  return units[static_cast<std::size_t>(kind)];
}

// The unit of a label over that of a rotation: "rad", "(deg/s)", "RAD/S2/N".
std::optional<double> rotation_of_label(const std::string& stated, const std::string& si) {
  const auto label = unit_of(stated);
  for (const auto& word : {label, lower(label)}) {
    if (const auto factor = factor_of(word, si)) return factor;
  }
  const auto stroke = label.rfind('/');
  if (stroke == std::string::npos || !force_unit(label.substr(stroke + 1))) return std::nullopt;
  return rotation_of_label(label.substr(0, stroke), si);
}

// The scale of a rotation. Many programs state a unit of length for all channels of a file.
UffScale rotation_scale(const UffAxis& axis, modal::FrfKind kind) {
  UffScale scale;
  scale.kind = kind;
  scale.unit = si_of_rotation(kind);
  const auto factor = rotation_of_label(axis.unit, scale.unit);
  scale.factor = factor.value_or(1.0);
  if (!factor && !axis.unit.empty()) {
    scale.note = "the unit " + shown(axis.unit) + " is none of a rotation: values are taken as " +
                 scale.unit;
  }
  return scale;
}

// The unit of a label over N m: "N m", "Nm", "N-mm", "lbf in".
std::optional<double> moment_of_label(const std::string& stated) {
  auto label = unit_of(stated);
  std::ranges::replace_if(
      label, [](char c) { return c == '-' || c == '*' || c == '.'; }, ' ');
  if (label.starts_with("Nm")) label.insert(1, " ");
  return factor_of(label, "N m");
}

// The scale of a moment. Many programs state a unit of force for all channels of a file.
UffScale moment_scale(const UffAxis& axis, const std::optional<UffUnits>& units) {
  UffScale scale;
  const auto force = force_unit(axis.unit);
  const bool is_stated = units || !axis.unit.empty();
  if (const auto label = moment_of_label(axis.unit)) {
    scale.factor = *label;
    scale.unit = "N m";
  } else if (force || (is_load(axis) && is_stated)) {
    const UffUnits of_file = units.value_or(UffUnits{});
    scale.factor = force.value_or(of_file.force) * of_file.length;
    scale.unit = "N m";
    if (!axis.unit.empty()) {
      scale.note = "the unit " + shown(axis.unit) + " is none of a moment: values are taken as " +
                   fmt::format("{:.6g} N m", scale.factor);
    }
  } else if (axis.type == 0) {
    scale.unit = axis.unit;  // another unit such as volts stays as it is
  }
  return scale;
}

}  // namespace

Eigen::Index UffChannels::number(const UffDof& dof, const std::string& name) {
  const auto [place, is_new] = numbers_.emplace(Key(dof.entity, dof.node, dof.direction), size());
  if (is_new) {
    dofs_.push_back(dof);
    names_.push_back(name);
  }
  return place->second;
}

std::vector<modal::MeasuredChannel> UffChannels::channels() const {
  const std::set<std::string> different(names_.begin(), names_.end());
  const bool named = different.size() == names_.size() && !different.contains("");
  std::vector<modal::MeasuredChannel> result;
  std::set<std::string> used;
  for (std::size_t c = 0; c < dofs_.size(); ++c) {
    auto& channel = result.emplace_back();
    channel.name = named ? names_[c] : name_of(dofs_[c]);
    if (!used.insert(channel.name).second) {
      channel.name = dofs_[c].entity + ":" + channel.name;
      used.insert(channel.name);
    }
    channel.node = dofs_[c].node;
    channel.direction = vector_of(dofs_[c].direction);
  }
  return result;
}

std::string name_of(const UffDof& dof) {
  constexpr const char* axes[] = {"", "x", "y", "z", "rx", "ry", "rz"};
  return (dof.direction < 0 ? "-" : "") + fmt::to_string(dof.node) +
         axes[static_cast<std::size_t>(std::abs(dof.direction))];
}

Eigen::Vector3d vector_of(int direction) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  const int axis = std::abs(direction);
  if (axis >= 1 && axis <= 3) result(axis - 1) = direction > 0 ? 1.0 : -1.0;
  return result;
}

UffScale motion_scale(const UffFunction& function) {
  const auto& axis = function.ordinate;
  const auto& units = function.units;
  UffScale scale;
  scale.kind = kind_of(axis.type);
  const auto label = motion_of_label(axis.unit);
  if (is_rotation(function.response) && (scale.kind || label)) {
    return rotation_scale(axis, scale.kind ? *scale.kind : *label->kind);
  }
  if (!scale.kind) scale.kind = kind_of(axis.label);
  if (label && scale.kind && label->kind != scale.kind) {
    scale.note = "the unit " + shown(axis.unit) + " is none of what " +
                 (kind_of(axis.type) ? "the type of the data" : "the label") +
                 " says: the unit beside the values is taken";
  }
  if (label) {
    scale.factor = label->factor;
    scale.unit = label->si;
    scale.kind = label->kind;
  } else if (axis.type == 0) {
    scale.unit = axis.unit;  // another unit such as volts stays as it is
  }
  if (!label && kind_of(axis.type) && !axis.unit.empty()) {
    scale.note = not_known(axis.unit, units.has_value());
  }
  if (!units || !kind_of(axis.type)) return scale;
  if (!label) {
    scale.factor = units->length;
    scale.unit = si_of(*scale.kind);
  } else if (scale.note.empty() && std::abs(scale.factor / units->length - 1.0) > 1e-3) {
    scale.note = "the unit " + shown(axis.unit) + " is not that of dataset 164 (" +
                 fmt::format("{:.6g}", units->length) + " m): the unit beside the values is taken";
  }
  return scale;
}

UffScale force_scale(const UffDof& dof, const UffAxis& axis, const std::optional<UffUnits>& units) {
  if (is_rotation(dof)) return moment_scale(axis, units);
  UffScale scale;
  if (const auto label = force_unit(axis.unit)) {
    scale.factor = *label;
    scale.unit = "N";
    if (units && std::abs(scale.factor / units->force - 1.0) > 1e-3) {
      scale.note = "the unit " + shown(axis.unit) + " is not that of dataset 164 (" +
                   fmt::format("{:.6g}", units->force) + " N): the unit beside the values is taken";
    }
  } else if (units && is_load(axis)) {
    scale.factor = units->force;
    scale.unit = "N";
    if (!axis.unit.empty()) scale.note = not_known(axis.unit, true);
  } else {
    scale.unit = axis.unit;  // another unit such as volts stays as it is
  }
  return scale;
}

namespace {

// The scale of an input whose force the unit of the response has in itself.
UffScale per_newton(const UffFunction& function) {
  UffScale scale;
  scale.unit = "N";
  const auto& input = function.denominator.unit;
  const auto force = force_unit(input);
  if (force && *force != 1.0 && !stands_in(unit_of(input), function.ordinate.unit)) {
    scale.note = "the unit " + shown(input) + " of the input is not that in " +
                 shown(function.ordinate.unit) + ": that of the response is taken";
  }
  return scale;
}

}  // namespace

UffScale input_scale(const UffFunction& function) {
  auto scale = force_scale(function.reference, function.denominator, function.units);
  if (is_rotation(function.reference)) return scale;
  if (is_over_newton(function.ordinate.unit)) return per_newton(function);
  const auto beside = force_beside_motion(function.ordinate.unit);
  if (!beside) return scale;
  if (function.denominator.unit.empty()) {
    scale = UffScale{};
    scale.factor = *beside;
    scale.unit = "N";
  } else if (scale.unit == "N" && std::abs(scale.factor / *beside - 1.0) > 1e-3) {
    scale.note = "the unit " + shown(function.denominator.unit) + " of the input is not that in " +
                 shown(function.ordinate.unit) + ": that of the input is taken";
  }
  return scale;
}

bool is_load(const UffAxis& axis) { return axis.type == 9 || axis.type == 13; }

bool is_motion(const UffAxis& axis) {
  if (axis.type != 0) return kind_of(axis.type).has_value();
  const auto unit = motion_unit(axis.unit);
  return kind_of(axis.label) || (unit && unit->kind != modal::FrfKind::receptance);
}

bool has_unit_of_motion(const UffAxis& axis) { return motion_of_label(axis.unit).has_value(); }

std::optional<double> abscissa_factor(const UffAxis& axis, const std::string& si) {
  const std::string label(trimmed(unit_of(axis.unit)));
  if (label.empty()) return 1.0;
  std::string word = label;
  if (upper(label).ends_with("HZ")) word.replace(word.size() - 2, 2, "Hz");
  if (upper(word) == "KHZ") word = "kHz";
  for (const auto& spelled : {word, lower(label)}) {
    if (const auto factor = factor_of(spelled, si)) return factor;
    if (si != "Hz") continue;
    if (const auto angular = factor_of(spelled, "rad/s")) return *angular / kTurn;
  }
  return si == "Hz" && upper(label).find("RAD") != std::string::npos ? std::optional(1.0 / kTurn)
                                                                     : std::nullopt;
}

std::string unknown_abscissa(const UffAxis& axis, const std::string& si) {
  return "the unit " + shown(axis.unit) + " of the abscissa is not known: values are taken as " +
         si;
}

UffDof dof_of(const modal::MeasuredChannel& channel, long long otherwise) {
  UffDof dof;
  dof.node = channel.node.value_or(otherwise);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(std::abs(channel.direction(axis)) - 1.0) > 1e-9) continue;
    dof.direction = channel.direction(axis) > 0.0 ? axis + 1 : -axis - 1;
  }
  dof.entity = channel.name.size() <= 10 && trimmed(channel.name) == channel.name &&
                       upper(channel.name) != "NONE"
                   ? channel.name
                   : "";
  return dof;
}

std::vector<std::vector<UffDof>> dofs_of(const UffSides& sides) {
  std::set<long long> taken;
  for (const auto* side : sides) {
    for (const auto& channel : *side) {
      if (channel.node) taken.insert(*channel.node);
    }
  }
  std::vector<std::vector<UffDof>> dofs;
  std::map<std::string, long long> given;
  long long next = 1;
  for (const auto* side : sides) {
    auto& of_side = dofs.emplace_back();
    for (const auto& channel : *side) {
      while (taken.contains(next)) ++next;
      const bool needs_one = !channel.node && given.emplace(channel.name, next).second;
      of_side.push_back(dof_of(channel, channel.node ? 0 : given.at(channel.name)));
      if (needs_one) ++next;
    }
  }
  return dofs;
}

std::map<long long, Eigen::Vector3d> places_of(const UffSides& sides,
                                               const std::vector<std::vector<UffDof>>& dofs,
                                               std::vector<std::string>& lost) {
  std::map<long long, Eigen::Vector3d> places;
  for (std::size_t s = 0; s < sides.size(); ++s) {
    for (std::size_t c = 0; c < sides[s]->size(); ++c) {
      const auto& channel = (*sides[s])[c];
      const auto& dof = dofs[s][c];
      if (dof.direction == 0 && channel.direction.any()) {
        lost.push_back("UFF holds directions along the axes only: that of " + channel.name +
                       " is left out");
      }
      if (!channel.position) continue;
      const auto [place, is_new] = places.emplace(dof.node, *channel.position);
      if (!is_new && place->second != *channel.position) {
        lost.push_back("UFF holds one place of a node: that of " + channel.name + ", at node " +
                       fmt::to_string(dof.node) + ", is left out");
      }
    }
  }
  return places;
}

std::string stated_name(const UffFunction& function, std::string_view mark, const UffDof& dof) {
  for (const auto& id : function.id) {
    if (std::string_view(id).starts_with(mark)) return id.substr(mark.size());
  }
  return dof.entity;
}

}  // namespace chladni::io
