// [[sensor]], [[actuator]], [[attachment]] and [[support]] of a study.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

Channel channel_of(TableReader& table, const Schema<Channel>& schema, const std::string& quantity) {
  Channel channel;
  channel.quantity = quantity;
  schema.read(table, channel);
  table.refuse_unknown();
  return channel;
}

/// Stiffness and damping, or natural frequency and damping ratio, of the mass on its spring.
fem::Resonator resonator_of(TableReader& table) {
  auto resonator = read_part(table, resonator_schema());
  if (table.has("frequency") == table.has("stiffness")) {
    table.missing("stiffness", "either stiffness or frequency, such as frequency = \"51.9 Hz\"");
  }
  if (const auto frequency = table.quantity("frequency", "Hz", Sign::positive)) {
    const double omega = 2.0 * std::numbers::pi * *frequency;
    resonator.stiffness = resonator.mass * omega * omega;
  }
  const auto ratio = table.quantity("damping_ratio", "1", Sign::not_negative);
  if (ratio && table.has("damping")) {
    table.wrong(*table.find("damping_ratio"), table.path() +
                                                  " has damping and damping_ratio; "
                                                  "expected one of them");
  } else if (ratio) {
    resonator.damping = 2.0 * *ratio * std::sqrt(resonator.stiffness * resonator.mass);
  }
  return resonator;
}

void read_kind(TableReader& table, AttachmentPlan& plan) {
  if (plan.kind == "mass") plan.what = read_part(table, mass_schema());
  if (plan.kind == "spring") plan.what = read_part(table, spring_schema());
  if (plan.kind == "damper") plan.what = read_part(table, damper_schema());
  if (plan.kind == "torsion_spring") plan.what = read_part(table, torsion_spring_schema());
  if (plan.kind == "resonator") plan.what = resonator_of(table);
  if (plan.kind == "link") {
    plan.what = read_part(table, link_schema());
    plan.to = read_place(table, "to");
  }
}

}  // namespace

const std::vector<std::string>& attachment_kinds() {
  // The last two became springs before they are read (study/device_arrays.h).
  static const std::vector<std::string> kinds = {
      "mass", "spring",    "damper",          "torsion_spring",
      "link", "resonator", "kinematic_mount", "air_bearing"};
  return kinds;
}

void Names::add(TableReader& table, const std::string& name) {
  if (name.empty()) return;
  const TomlNode* node = table.find("name");
  for (const auto& [other, line] : seen_) {
    if (other != name) continue;
    table.wrong(*node, "two " + what_ + "s are called \"" + name + "\": line " +
                           fmt::to_string(line) + " and line " + fmt::to_string(node->line));
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
    if (!table.has("kind")) table.missing("kind", listed(attachment_kinds()));
    plan.kind = table.choice("kind", attachment_kinds()).value_or("");
    attachment_schema().read(table, plan);
    names.add(table, plan.name);
    read_kind(table, plan);
    if (!plan.kind.empty()) table.refuse_unknown();
    study.attachments.push_back(plan);
  }
}

void read_supports(TableReader& root, Study& study) {
  for (auto& table : root.tables("support")) {
    study.supports.push_back(read_part(table, support_schema()));
    table.refuse_unknown();
    study.support_lines.push_back(table.line());
  }
}

}  // namespace chladni::study
