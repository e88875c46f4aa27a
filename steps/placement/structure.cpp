// The study's plan and structure as the room `placement` takes them.
#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "mesh/surface.h"
#include "stage/points_on_body.h"
#include "steps/observer/stated.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

bool stays(const study::PlacementPlan& plan, const study::Channel& channel) {
  return std::find(plan.there.begin(), plan.there.end(), channel.name) != plan.there.end();
}

// Slopes along the surface of what each channel measures or drives.
Eigen::MatrixXd slopes_at(const placement::Channels& channels, const std::vector<mesh::Site>& sites,
                          const stage::Solution& solution) {
  Eigen::MatrixXd slopes(channels.count(), channels.shapes.cols());
  std::vector<Eigen::Index> left(sites.size());
  std::iota(left.begin(), left.end(), 0);
  while (!left.empty()) {
    const Eigen::Vector3d direction = channels.lines.direction.row(left.front()).transpose();
    const placement::Sampler sampler(solution.model.body, solution.modes, {direction, 0.0});
    std::erase_if(left, [&](Eigen::Index i) {
      if (channels.lines.direction.row(i).transpose() != direction) return false;
      slopes.row(i) = sampler.at({sites[static_cast<std::size_t>(i)]}).slopes.row(0);
      return true;
    });
  }
  return slopes;
}

placement::Channels channels_at(const std::vector<study::Channel>& channels,
                                const std::vector<mesh::Site>& sites,
                                const stage::Solution& solution, const study::PlacementPlan& plan) {
  const auto count = static_cast<Eigen::Index>(channels.size());
  placement::Channels result;
  result.lines = {Points(count, 3), Points(count, 3)};
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    result.lines.position.row(row) = sites[i].position.transpose();
    result.lines.direction.row(row) = channels[i].direction.transpose();
    result.stays.push_back(stays(plan, channels[i]) ? 1 : 0);
  }
  result.shapes = stage::shapes_at(channels, sites, solution.modes);
  if (plan.position_error > 0.0) result.slopes = slopes_at(result, sites, solution);
  return result;
}

Eigen::MatrixXd shapes_of_interest(const study::Study& study, const stage::Solution& solution,
                                   const study::PlacementPlan& plan) {
  const placement::Sampler sampler(solution.model.body, solution.modes, {plan.direction, 0.0});
  const auto& finder = sampler.finder();
  std::vector<mesh::Site> points;
  const double reach = stage::reach_of(solution.model.body);
  for (const auto& place : plan.interest) {
    points.push_back(site_of(study, finder, reach, place, "a point of interest"));
  }
  return sampler.at(points).shapes;
}

// Number of sites: one for each point of the study's channels where no channel stays; 0 if none is
// left. A collocated pair is one point.
int sites_wanted(const study::PlacementPlan& plan, const placement::Structure& structure) {
  if (plan.sites > 0) return plan.sites;
  const auto& sensors = structure.sensors;
  const auto& actuators = structure.actuators;
  auto points = sensors.count() + actuators.count() - std::ssize(plan.there);
  for (const auto& [sensor, actuator] :
       placement::collocated_pairs(sensors.lines, actuators.lines, structure.size)) {
    if (!sensors.keeps(sensor) || !actuators.keeps(actuator)) --points;
  }
  return static_cast<int>(std::max<Eigen::Index>(0, points));
}

}  // namespace

study::PlacementPlan placement_plan(const study::Study& study) {
  return study.placement.value_or(study::PlacementPlan{});
}

placement::Plan room_plan(const study::PlacementPlan& plan, const placement::Structure& structure) {
  placement::Plan room;
  room.modes = plan.modes;
  room.up_to_hz = plan.up_to_hz;
  room.criterion = plan.criterion;
  room.frequency_tolerance = plan.frequency_tolerance;
  room.noise = plan.noise;
  room.frf_noise = plan.frf_noise;
  room.resolution_hz = plan.resolution_hz;
  room.position_error = plan.position_error;
  const bool mean = plan.uncertainty && !plan.uncertainty->worst;
  room.over = mean ? placement::Over::mean : placement::Over::worst;
  room.spacing = plan.spacing;
  room.pairs = plan.pairs;
  room.sites = sites_wanted(plan, structure);
  room.by_interpolation = plan.choose_by == "interpolation_error";
  room.by_observer = plan.choose_by == "observer";
  if (plan.observer) {
    room.devices = {plan.observer->sensors, plan.observer->actuators, plan.observer->pairs};
  }
  return room;
}

placement::Structure structure_of(const study::Study& study, const stage::Solution& solution,
                                  const study::PlacementPlan& plan, unsigned seed) {
  const auto& modes = solution.modes;
  const auto& model = solution.model;
  const auto box = mesh::bounding_box(model.body.points);
  placement::Structure structure;
  structure.frequency_hz = modes.frequency_hz;
  structure.damping_ratio = modes.damping_ratio;
  structure.rigid_count = modes.rigid_count;
  structure.mass_kg = model.mass.mass_kg;
  structure.size = (box.row(1) - box.row(0)).norm();
  structure.sensors = channels_at(study.sensors, model.sensors, solution, plan);
  structure.actuators = channels_at(study.actuators, model.actuators, solution, plan);
  if (plan.uncertainty) structure.ensemble = stage::ensemble(solution, *plan.uncertainty, seed);
  structure.interest = shapes_of_interest(study, solution, plan);
  return structure;
}

}  // namespace chladni::steps
