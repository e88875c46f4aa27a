#include "steps/identification/identification_gains.h"

#include <optional>

#include "mesh/surface.h"
#include "stage/body.h"
#include "stage/corrections.h"
#include "stage/faces.h"
#include "steps/interpolation.h"

namespace chladni::steps {
namespace {

Eigen::MatrixXd simulated_rows(const std::vector<modal::MeasuredChannel>& measured,
                               const std::vector<study::Channel>& channels,
                               const std::vector<mesh::Site>& sites, const modal::Modes& modes) {
  const auto shapes = stage::shapes_at(channels, sites, modes);
  std::vector<Eigen::Index> rows;
  for (const auto& channel : measured) rows.push_back(index_of(channels, channel.name));
  return shapes(rows, Eigen::all);
}

identification::SimulatedChannels simulated_channels(const study::Study& study,
                                                     const stage::Solution& solution,
                                                     const modal::FrfSet& seen) {
  const auto& model = solution.model;
  return {solution.modes.frequency_hz,
          simulated_rows(seen.outputs, study.sensors, model.sensors, solution.modes),
          simulated_rows(seen.inputs, study.actuators, model.actuators, solution.modes)};
}

// Prior of the simulation for the scale between sensors and actuators, where no pair gives it.
identification::GainPrior gain_prior(const study::Study& study, const stage::Solution& solution,
                                     const IdentifiedModel& model) {
  const auto on = study.interpolation ? study.interpolation->on : study::FacePlan{};
  const auto faces = stage::faces_of(study, solution.model.body, on, "interpolation.on");
  const placement::Sampler sampler(solution.model.body, solution.modes, {faces.direction, 0.0});
  const auto surface = stage::surface_on(sampler, faces);
  priors::Simulation simulation;
  simulation.frequency_hz = solution.modes.frequency_hz;
  simulation.surface = {surface.sites.position,
                        stage::directions_on(surface.sites, faces.direction), surface.sites.shapes};
  simulation.area = surface.sites.area;
  simulation.corrections = stage::corrections(solution);
  const auto sites = channel_sites(study, solution.model);
  const auto places = [&](const std::vector<modal::MeasuredChannel>& channels) {
    std::vector<ChannelSite> chosen;
    for (const auto& channel : channels) {
      chosen.push_back(sites[static_cast<std::size_t>(index_of(sites, channel.name))]);
    }
    return places_at(chosen, solution.modes);
  };
  return identification::simulated_gain_prior(
      model.found.fit, simulation, places(model.seen.outputs), places(model.seen.inputs));
}

identification::GainPlan gain_plan(const study::Study& study) {
  const auto plan = identification_plan(study);
  identification::GainPlan gains;
  gains.pairs = plan.pairs;
  gains.pairs_within = plan.pairs_within;
  if (plan.gain == "thesis") gains.rule = identification::GainRule::thesis;
  if (plan.gain_errors == "sensors") gains.fault = identification::GainFault::outputs;
  if (plan.gain_errors == "actuators") gains.fault = identification::GainFault::inputs;
  gains.suspended_modes = plan.suspended_modes;
  gains.is_supported = !study.supports.empty();
  gains.source = study.file.string() + ": ";
  return gains;
}

}  // namespace

identification::ChannelGains gains_of(const study::Study& study, const stage::Solution* solution,
                                      const IdentifiedModel& model, stage::Work& work) {
  identification::GainSimulation simulation;
  simulation.at_channels = [&] {
    if (solution != nullptr) return simulated_channels(study, *solution, model.seen);
    return simulated_channels(study, stage::solved(study, work), model.seen);
  };
  simulation.size_m = [&] {
    const Points points =
        solution != nullptr ? solution->model.body.points : stage::outline_of(study).shell.points;
    const auto box = mesh::bounding_box(points);
    return (box.row(1) - box.row(0)).norm();
  };
  if (solution != nullptr) simulation.prior = [&] { return gain_prior(study, *solution, model); };
  return identification::channel_gains(model.found.fit, model.seen, gain_plan(study), simulation);
}

}  // namespace chladni::steps
