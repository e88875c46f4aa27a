#include "study/tables/mounts.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "study/device_arrays.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

using NodeKind = TomlNode::Kind;

constexpr int kSpringsOfPad = 6;

std::string kind_of(const TomlNode& element) {
  const auto* kind = element.kind == NodeKind::table ? member(element, "kind") : nullptr;
  return kind != nullptr && kind->kind == NodeKind::text ? kind->text : std::string();
}

TomlNode direction_node(const Eigen::Vector3d& direction, const TomlNode& like) {
  TomlNode node = text_node("", like);
  node.kind = NodeKind::array;
  for (const double value : direction) {
    auto number = text_node(fmt::format("{}", value + 0.0), like);
    number.kind = NodeKind::real;
    number.number = value + 0.0;
    node.elements.push_back(std::move(number));
  }
  return node;
}

/// The keys of one spring.
struct Spring {
  std::string name;
  Eigen::Vector3d point, direction;
  double stiffness = 0.0, damping = 0.0, footprint = 0.0;
};

TomlNode spring_node(const Spring& spring, bool from_above, const TomlNode& like) {
  TomlNode node = text_node("", like);
  node.kind = NodeKind::table;
  const auto put = [&](const char* key, TomlNode value) {
    node.members.push_back({key, like.line, like.column, std::move(value)});
  };
  const auto quantity = [&](const char* key, double value, const char* unit) {
    if (value > 0.0) put(key, text_node(fmt::format("{} {}", value, unit), like));
  };
  put("kind", text_node("spring", like));
  put("name", text_node(spring.name, like));
  put("at", place_node(spring.point, from_above, like));
  put("direction", direction_node(spring.direction, like));
  quantity("stiffness", spring.stiffness, "N/m");
  quantity("damping", spring.damping, "N s/m");
  quantity("footprint", spring.footprint, "m");
  return node;
}

template <typename Plan>
Plan plan_of(TableReader& table, const Schema<Plan>& schema) {
  for (const auto* known : {"kind", "name", "at"}) static_cast<void>(table.find(known));
  return read_part(table, schema);
}

std::vector<Spring> springs_of_groove(const TomlNode& element, const ArrayPlace& place,
                                      Problems& problems) {
  TableReader table(element, "attachment", problems);
  auto plan = plan_of(table, mount_schema());
  Eigen::Vector3d groove(place.outward.x(), place.outward.y(), 0.0);
  if (const auto given = table.direction("groove")) {
    groove = {given->x(), given->y(), 0.0};
  } else if (groove.isZero() && !table.has("groove")) {
    table.missing("groove",
                  "\"x\", \"-y\" or three numbers, where the mount is no part of an "
                  "array around a centre");
  }
  table.refuse_unknown();
  if (groove.norm() < 1e-9 || !(plan.stiffness > 0.0)) return {};
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(groove).normalized();
  const auto name = element_name(element);
  if (!(plan.lateral_stiffness > 0.0)) plan.lateral_stiffness = plan.stiffness;
  return {{name + "_z", place.point, Eigen::Vector3d::UnitZ(), plan.stiffness, plan.damping,
           plan.footprint},
          {name + "_t", place.point, across, plan.lateral_stiffness, plan.lateral_damping,
           plan.footprint}};
}

std::vector<Spring> springs_of_pad(const TomlNode& element, const ArrayPlace& place,
                                   Problems& problems) {
  TableReader table(element, "attachment", problems);
  const auto plan = plan_of(table, air_bearing_schema());
  const auto direction = table.direction("direction").value_or(Eigen::Vector3d::UnitZ());
  table.refuse_unknown();
  if (!(plan.stiffness > 0.0 && plan.diameter > 0.0)) return {};
  if (place.from_above && std::abs(direction.z()) < 1.0 - 1e-9) {
    table.wrong(element, "attachment \"" + element_name(element) +
                             "\": a pad that is not along z needs a place of three lengths");
    return {};
  }
  const Eigen::Vector3d first = std::abs(direction.z()) > 0.9
                                    ? Eigen::Vector3d::UnitX()
                                    : Eigen::Vector3d::UnitZ().cross(direction).normalized();
  const Eigen::Vector3d u = (first - first.dot(direction) * direction).normalized();
  const Eigen::Vector3d v = direction.cross(u);
  const double radius = 0.5 * plan.diameter / std::numbers::sqrt2;
  std::vector<Spring> all;
  for (int i = 0; i < kSpringsOfPad; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSpringsOfPad;
    all.push_back({fmt::format("{}_{}", element_name(element), i + 1),
                   place.point + radius * (std::cos(angle) * u + std::sin(angle) * v), direction,
                   plan.stiffness / kSpringsOfPad, plan.damping / kSpringsOfPad, 0.0});
  }
  return all;
}

}  // namespace

bool is_mount(const TomlNode& element) {
  const auto kind = kind_of(element);
  return kind == "kinematic_mount" || kind == "air_bearing";
}

std::vector<TomlNode> springs_of(const TomlNode& element, const ArrayPlace& place,
                                 Problems& problems) {
  const auto springs = kind_of(element) == "air_bearing"
                           ? springs_of_pad(element, place, problems)
                           : springs_of_groove(element, place, problems);
  std::vector<TomlNode> nodes;
  for (const auto& spring : springs) {
    nodes.push_back(spring_node(spring, place.from_above, element));
  }
  return nodes;
}

}  // namespace chladni::study
