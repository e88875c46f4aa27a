// Places where the study allows devices.
#include <fmt/format.h>

#include <algorithm>

#include "mesh/faces.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

// Devices are at least so far apart.
constexpr double kApart = 1e-4;        // [m]
constexpr double kApartOfBody = 0.01;  // of the diagonal, on a small body

std::string millimetres(const Eigen::Vector2d& at) {
  return fmt::format("({:.6g}, {:.6g}) mm", 1e3 * at.x(), 1e3 * at.y());
}

placement::Rule rule_of(const study::KeepOut& zone, const mesh::TetMesh& body,
                        const std::string& key) {
  if (zone.shape == "box") {
    return {"the box from " + millimetres(zone.from) + " to " + millimetres(zone.to),
            placement::KeepOutBox{zone.from, zone.to}};
  }
  if (zone.shape == "disc") {
    return {fmt::format("the disc of {:.6g} mm at ", 1e3 * zone.diameter) + millimetres(zone.from),
            placement::KeepOutDisc{zone.from, zone.diameter}};
  }
  return {"the patch \"" + zone.patch + "\"",
          placement::KeepOutPatch{mesh::patch_number(body, zone.patch, key)}};
}

// Places of the channels that stay.
Points places_that_stay(const placement::Structure& structure) {
  Points points(0, 3);
  for (const auto* channels : {&structure.sensors, &structure.actuators}) {
    for (Eigen::Index i = 0; i < channels->count(); ++i) {
      if (!channels->keeps(i)) continue;
      points.conservativeResize(points.rows() + 1, Eigen::NoChange);
      points.bottomRows<1>() = channels->lines.position.row(i);
    }
  }
  return points;
}

}  // namespace

std::vector<placement::Rule> zones_of(const mesh::TetMesh& body,
                                      const std::vector<study::KeepOut>& zones,
                                      const std::string& key) {
  std::vector<placement::Rule> rules;
  for (const auto& zone : zones) rules.push_back(rule_of(zone, body, key));
  return rules;
}

std::vector<placement::Rule> rules_of(const mesh::TetMesh& body, const study::PlacementPlan& plan,
                                      const placement::Structure& structure,
                                      const stage::Faces& faces) {
  auto rules = zones_of(body, plan.keep_out, "placement.keep_out");
  if (plan.footprint > 0.0) {
    rules.push_back(
        {fmt::format("a footprint of {:.6g} mm that lies on the body", 1e3 * plan.footprint),
         placement::WholeFootprints{}});
  }
  if (plan.edge_distance > 0.0) {
    rules.push_back({fmt::format("the distance of {:.6g} mm from edges", 1e3 * plan.edge_distance),
                     stage::edges_on(body, faces, plan.edge_distance)});
  }
  const Points present = places_that_stay(structure);
  const double least = std::min(kApart, kApartOfBody * structure.size);
  const double apart = std::max({plan.spacing, plan.footprint, least});
  if (present.rows() > 0) {
    rules.push_back({fmt::format("the distance of {:.6g} mm from what is there", 1e3 * apart),
                     placement::KeepFromPlaces{apart, present}});
  }
  return rules;
}

}  // namespace chladni::steps
