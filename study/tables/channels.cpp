// [[sensor]], [[actuator]], [[attachment]] and [[support]] of a study.
#include <cmath>
#include <numbers>

#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

Eigen::Vector3d required_direction(TableReader& table, std::string_view key) {
  if (!table.has(key)) {
    table.missing(key, "\"x\", \"y\", \"z\", \"-x\", \"-y\", \"-z\" or three numbers");
  }
  return table.direction(key).value_or(Eigen::Vector3d::UnitZ());
}

Channel channel_of(TableReader& table, const Schema<Channel>& schema, const std::string& quantity) {
  Channel channel;
  channel.quantity = quantity;
  schema.read(table, channel);
  table.refuse_unknown();
  return channel;
}

fem::PointMass mass_of(TableReader& table) {
  fem::PointMass mass;
  mass.mass = table.required_quantity("mass", "kg", Sign::positive);
  if (const auto inertia = table.quantities("inertia", "kg m^2", 3, Sign::not_negative)) {
    mass.inertia = inertia->asDiagonal();
  }
  return mass;
}

template <typename Spring>
void read_rates(TableReader& table, std::string_view stiffness_unit, std::string_view damping_unit,
                bool needs_stiffness, Spring& spring) {
  if (needs_stiffness) {
    spring.stiffness = table.required_quantity("stiffness", stiffness_unit, Sign::positive);
    spring.damping = table.quantity("damping", damping_unit, Sign::not_negative).value_or(0.0);
  } else {
    spring.damping = table.required_quantity("damping", damping_unit, Sign::positive);
  }
}

fem::GroundSpring spring_of(TableReader& table, bool needs_stiffness) {
  fem::GroundSpring spring;
  spring.direction = required_direction(table, "direction");
  read_rates(table, "N/m", "N s/m", needs_stiffness, spring);
  return spring;
}

fem::GroundTorsionSpring torsion_spring_of(TableReader& table) {
  fem::GroundTorsionSpring spring;
  spring.axis = required_direction(table, "axis");
  read_rates(table, "N m/rad", "N m s/rad", true, spring);
  return spring;
}

fem::LinkSpring link_of(TableReader& table) {
  fem::LinkSpring link;
  link.direction = table.direction("direction").value_or(Eigen::Vector3d::Zero());
  read_rates(table, "N/m", "N s/m", true, link);
  return link;
}

/// Stiffness and damping, or natural frequency and damping ratio, of the mass on its spring.
fem::Resonator resonator_of(TableReader& table) {
  fem::Resonator resonator;
  resonator.direction = required_direction(table, "direction");
  resonator.mass = table.required_quantity("mass", "kg", Sign::positive);
  const auto frequency = table.quantity("frequency", "Hz", Sign::positive);
  const auto stiffness = table.quantity("stiffness", "N/m", Sign::positive);
  if (table.has("frequency") == table.has("stiffness")) {
    table.missing("stiffness", "either stiffness or frequency, such as frequency = \"51.9 Hz\"");
  }
  const double omega = 2.0 * std::numbers::pi * frequency.value_or(0.0);
  resonator.stiffness = stiffness.value_or(resonator.mass * omega * omega);
  const auto damping = table.quantity("damping", "N s/m", Sign::not_negative);
  const auto ratio = table.quantity("damping_ratio", "1", Sign::not_negative);
  if (damping && ratio) {
    table.wrong(*table.find("damping_ratio"), table.path() +
                                                  " has damping and damping_ratio; "
                                                  "expected one of them");
  }
  resonator.damping =
      damping.value_or(2.0 * ratio.value_or(0.0) * std::sqrt(resonator.stiffness * resonator.mass));
  return resonator;
}

void read_kind(TableReader& table, AttachmentPlan& plan) {
  if (plan.kind == "mass") plan.what = mass_of(table);
  if (plan.kind == "spring") plan.what = spring_of(table, true);
  if (plan.kind == "damper") plan.what = spring_of(table, false);
  if (plan.kind == "torsion_spring") plan.what = torsion_spring_of(table);
  if (plan.kind == "resonator") plan.what = resonator_of(table);
  if (plan.kind == "link") {
    plan.what = link_of(table);
    plan.to = read_place(table, "to");
  }
}

}  // namespace

void Names::add(TableReader& table, const std::string& name) {
  if (name.empty()) return;
  const TomlNode* node = table.find("name");
  for (const auto& [other, line] : seen_) {
    if (other != name) continue;
    table.wrong(*node, "two " + what_ + "s are called \"" + name + "\": line " +
                           std::to_string(line) + " and line " + std::to_string(node->line));
    return;
  }
  seen_.emplace_back(name, node->line);
}

Place read_place(TableReader& table, std::string_view key) {
  Place place;
  const TomlNode* node = table.find(key);
  if (node == nullptr) {
    table.missing(key,
                  "two lengths (onto the top along z) or three (the nearest point), such as "
                  "[\"-250 mm\", \"250 mm\"]");
    return place;
  }
  place.line = node->line;
  const auto count = static_cast<Eigen::Index>(node->elements.size());
  if (node->kind != TomlNode::Kind::array || count < 2 || count > 3) {
    table.wrong(*node, table.name(key) + " is " + description(*node) +
                           "; expected two or three lengths, such as [\"-250 mm\", \"250 mm\"]");
    return place;
  }
  place.from_above = count == 2;
  if (const auto point = table.quantities(key, "m", count)) place.point.head(count) = *point;
  return place;
}

io::Json place_json(const Place& place) {
  return io::Json(place.point.head(place.from_above ? 2 : 3));
}

void read_channels(TableReader& root, Study& study) {
  Names sensors("sensor");
  for (auto& table : root.tables("sensor")) {
    study.sensors.push_back(channel_of(table, sensor_schema(), "displacement"));
    sensors.add(table, study.sensors.back().name);
  }
  Names actuators("actuator");
  for (auto& table : root.tables("actuator")) {
    study.actuators.push_back(channel_of(table, actuator_schema(), "force"));
    actuators.add(table, study.actuators.back().name);
  }
}

void read_attachments(TableReader& root, Study& study) {
  Names names("attachment");
  for (auto& table : root.tables("attachment")) {
    AttachmentPlan plan;
    const std::vector<std::string> kinds = {"mass",           "spring", "damper",
                                            "torsion_spring", "link",   "resonator"};
    if (!table.has("kind")) table.missing("kind", listed(kinds));
    plan.kind = table.choice("kind", kinds).value_or("");
    plan.name = table.required_text("name");
    plan.at = read_place(table, "at");
    plan.footprint = table.quantity("footprint", "m", Sign::not_negative).value_or(0.0);
    names.add(table, plan.name);
    read_kind(table, plan);
    if (!plan.kind.empty()) table.refuse_unknown();
    study.attachments.push_back(plan);
  }
}

void read_supports(TableReader& root, Study& study) {
  for (auto& table : root.tables("support")) {
    fem::Support support;
    support.patch = table.required_text("patch");
    const std::string axes = table.required_text("fixed");
    if (axes.find_first_not_of("xyz") != std::string::npos) {
      table.wrong(*table.find("fixed"), table.name("fixed") + " is \"" + axes +
                                            "\"; expected some of the letters x, y and z");
    }
    support.x = axes.find('x') != std::string::npos;
    support.y = axes.find('y') != std::string::npos;
    support.z = axes.find('z') != std::string::npos;
    table.refuse_unknown();
    study.supports.push_back(support);
    study.support_lines.push_back(table.line());
  }
}

}  // namespace chladni::study
