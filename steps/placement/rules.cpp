// Places where the study allows devices.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "mesh/faces.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

std::string millimetres(const Eigen::Vector2d& at) {
  return fmt::format("({:.6g}, {:.6g}) mm", 1e3 * at.x(), 1e3 * at.y());
}

placement::Rule rule_of(const study::KeepOut& zone, const mesh::TetMesh& body) {
  if (zone.shape == "box") {
    return {"the box from " + millimetres(zone.from) + " to " + millimetres(zone.to),
            placement::KeepOutBox{zone.from, zone.to}};
  }
  if (zone.shape == "disc") {
    return {fmt::format("the disc of {:.6g} mm at ", 1e3 * zone.diameter) + millimetres(zone.from),
            placement::KeepOutDisc{zone.from, zone.diameter}};
  }
  return {"the patch \"" + zone.patch + "\"",
          placement::KeepOutPatch{mesh::patch_number(body, zone.patch, "placement.keep_out")}};
}

// Places of the channels that stay.
Points places_there(const study::Study& study, const stage::Solution& solution,
                    const study::PlacementPlan& plan) {
  std::vector<Eigen::Vector3d> places;
  const auto add = [&](const std::vector<study::Channel>& channels,
                       const std::vector<mesh::Site>& sites) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (stays(plan, channels[i])) places.push_back(sites[i].position);
    }
  };
  add(study.sensors, solution.model.sensors);
  add(study.actuators, solution.model.actuators);
  Points points(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) {
    points.row(static_cast<Eigen::Index>(i)) = places[i].transpose();
  }
  return points;
}

}  // namespace

std::vector<placement::Rule> rules_of(const study::Study& study, const stage::Solution& solution,
                                      const study::PlacementPlan& plan, const stage::Faces& faces) {
  const auto& body = solution.model.body;
  std::vector<placement::Rule> rules;
  for (const auto& zone : plan.keep_out) rules.push_back(rule_of(zone, body));
  if (plan.footprint > 0.0) {
    rules.push_back(
        {fmt::format("a footprint of {:.6g} mm that lies on the body", 1e3 * plan.footprint),
         placement::WholeFootprints{}});
  }
  if (plan.edge_distance > 0.0) {
    rules.push_back({fmt::format("the distance of {:.6g} mm from edges", 1e3 * plan.edge_distance),
                     stage::edges_on(body, faces, plan.edge_distance)});
  }
  const Points there = places_there(study, solution, plan);
  const double apart = std::max({plan.spacing, plan.footprint, 1e-4});
  if (there.rows() > 0) {
    rules.push_back({fmt::format("the distance of {:.6g} mm from what is there", 1e3 * apart),
                     placement::KeepFromPlaces{apart, there}});
  }
  return rules;
}

Candidates candidates_of(const study::PlacementPlan& plan, const placement::Sampler& sampler,
                         const Placed& placed) {
  if (!plan.grid) {
    return {placement::part(placed.surface.sites,
                            placement::admissible(placed.forbidden, placed.rules)),
            false};
  }
  const auto& grid = *plan.grid;
  std::vector<mesh::Site> places;
  for (int i = 0; i < grid.columns; ++i) {
    for (int j = 0; j < grid.rows; ++j) {
      const Eigen::Vector2d offset(i - 0.5 * (grid.columns - 1), j - 0.5 * (grid.rows - 1));
      const Eigen::Vector2d at = grid.centre + offset.cwiseProduct(grid.pitch);
      if (const auto site = sampler.finder().from_above(at.x(), at.y())) places.push_back(*site);
    }
  }
  require(!places.empty(), "placement.grid: none of its places lies on the body");
  const auto sites = sampler.at(places);
  const auto forbidden = placement::forbidden_by(sites, placed.rules);
  return {placement::part(sites, placement::admissible(forbidden, placed.rules)), true};
}

}  // namespace chladni::steps
