#include "steps/identification/identification_gains.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "identification/suspension.h"
#include "priors/learned_corrections.h"
#include "stage/corrections.h"
#include "stage/faces.h"
#include "steps/interpolation.h"
#include "steps/placement.h"

namespace chladni::steps {
namespace {

constexpr double kLargestMode = 0.15;  // deviation of ln f between a mode and its simulation

// Removes the coordinate along a channel's own direction: a sensor and an actuator on the two faces
// of a plate are then in one place.
std::vector<modal::MeasuredChannel> along(std::vector<modal::MeasuredChannel> channels) {
  for (auto& one : channels) {
    *one.position -= one.direction * one.direction.dot(*one.position);
  }
  return channels;
}

std::vector<identification::CollocatedPair> pairs_of(const study::IdentificationPlan& plan,
                                                     const modal::FrfSet& seen) {
  if (plan.pairs.empty()) {
    return identification::collocated_pairs(along(seen.outputs), along(seen.inputs),
                                            plan.pairs_within);
  }
  std::vector<identification::CollocatedPair> pairs;
  for (const auto& [sensor, actuator] : plan.pairs) {
    identification::CollocatedPair pair;
    pair.output = index_of(seen.outputs, sensor);
    pair.input = index_of(seen.inputs, actuator);
    if (pair.output >= 0 && pair.input >= 0) pairs.push_back(std::move(pair));
  }
  return pairs;
}

double distance(const modal::FrfSet& set, const identification::CollocatedPair& pair) {
  const auto& output = set.outputs[static_cast<std::size_t>(pair.output)];
  const auto& input = set.inputs[static_cast<std::size_t>(pair.input)];
  const Eigen::Vector3d apart = *output.position - *input.position;
  return (apart - output.direction * output.direction.dot(apart)).norm();
}

Eigen::MatrixXd simulated_rows(const std::vector<modal::MeasuredChannel>& measured,
                               const std::vector<study::Channel>& channels,
                               const std::vector<mesh::Site>& sites, const modal::Modes& modes) {
  const auto all = stage::shapes_at(channels, sites, modes);
  std::vector<Eigen::Index> rows;
  for (const auto& one : measured) {
    rows.push_back(index_of(channels, one.name));
  }
  return all(rows, Eigen::all);
}

double alike(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::pow(a.dot(b), 2) / std::max(1e-300, a.squaredNorm() * b.squaredNorm());
}

// The simulated mode that is most like a fitted mode, on both sides and in frequency.
Eigen::Index simulated_mode(const modal::ReducedModel& fit, Eigen::Index mode,
                            const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs,
                            const modal::Modes& modes) {
  Eigen::Index best = modes.rigid_count;
  double likeness = -1.0;
  for (auto r = modes.rigid_count; r < modes.mode_count(); ++r) {
    const double ratio = std::log(fit.frequency_hz(mode) / modes.frequency_hz(r)) / kLargestMode;
    const double here = alike(fit.output_shapes.col(mode), outputs.col(r)) *
                        alike(fit.input_shapes.row(mode).transpose(), inputs.col(r)) *
                        std::exp(-0.5 * ratio * ratio);
    if (here > likeness) {
      likeness = here;
      best = r;
    }
  }
  return best;
}

// Adds the simulated shapes at the two places of each pair, mode by mode.
void add_simulated_pairs(const study::Study& study, const stage::Solution& solution,
                         IdentifiedModel& model) {
  const auto& seen = model.seen;
  const auto& fit = model.found.fit.model;
  const auto outputs =
      simulated_rows(seen.outputs, study.sensors, solution.model.sensors, solution.modes);
  const auto inputs =
      simulated_rows(seen.inputs, study.actuators, solution.model.actuators, solution.modes);
  const auto m = fit.mode_count();
  for (auto& pair : model.pairs) {
    if (distance(seen, pair) <= 1e-3) continue;
    pair.at_output.setOnes(m);
    pair.at_input.setOnes(m);
    for (auto mode = fit.rigid_count; mode < m; ++mode) {
      const auto r = simulated_mode(fit, mode, outputs, inputs, solution.modes);
      pair.at_output(mode) = outputs(pair.output, r);
      pair.at_input(mode) = inputs(pair.input, r);
    }
  }
}

bool needs_simulation(const IdentifiedModel& model) {
  return std::any_of(model.pairs.begin(), model.pairs.end(),
                     [&](const auto& pair) { return distance(model.seen, pair) > 1e-3; });
}

// Number of rigid-body motions along z that the channels' places can tell apart: 2 for a line along
// x, 3 for a plane.
Eigen::Index motions_told(const modal::FrfSet& seen) {
  constexpr double kLine = 1e-3;  // [m]
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const auto* side : {&seen.outputs, &seen.inputs}) {
    for (const auto& one : *side) {
      least = std::min(least, one.position->y());
      most = std::max(most, one.position->y());
    }
  }
  return most - least > kLine ? 3 : 2;
}

// Geometry of rigid-body motions, if all channels move along z and their places are distinct.
std::optional<identification::RigidGeometry> geometry_of(const modal::FrfSet& seen,
                                                         Eigen::Index motions) {
  const auto rows = [&](const std::vector<modal::MeasuredChannel>& channels) {
    Eigen::MatrixX3d places(static_cast<Eigen::Index>(channels.size()), 3);
    Eigen::VectorXd sign(places.rows());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      places.row(static_cast<Eigen::Index>(i)) = channels[i].position->transpose();
      sign(static_cast<Eigen::Index>(i)) = channels[i].direction.z();
    }
    return Eigen::MatrixXd(sign.asDiagonal() *
                           identification::rigid_directions(places, rigid_motion(motions)));
  };
  const auto along_z = [](const auto& one) { return std::abs(one.direction.z()) > 0.999; };
  if (!std::all_of(seen.outputs.begin(), seen.outputs.end(), along_z) ||
      !std::all_of(seen.inputs.begin(), seen.inputs.end(), along_z)) {
    return std::nullopt;
  }
  identification::RigidGeometry geometry{rows(seen.outputs), rows(seen.inputs), {}, 0.0, true};
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> outputs(geometry.outputs);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> inputs(geometry.inputs);
  if (std::max(outputs.rank(), inputs.rank()) < motions) return std::nullopt;
  return geometry;
}

// Rigid-body motion: at 0 Hz, or on the springs that hold the body.
std::optional<identification::RigidGeometry> rigid_geometry(const study::Study& study,
                                                            const IdentifiedModel& model) {
  const auto plan = identification_plan(study);
  const auto& fit = model.found.fit;
  const auto rigid = fit.model.rigid_count;
  if (rigid > 0) {
    return rigid == 2 || rigid == 3 ? geometry_of(model.seen, rigid) : std::nullopt;
  }
  if (plan.suspended_modes == 0) return std::nullopt;
  auto geometry = geometry_of(model.seen, motions_told(model.seen));
  require(
      geometry || plan.suspended_modes < 0,
      study.file.string() +
          ": identification.suspended_modes needs channels that all act along z, on one side as "
          "many as tell the motions of the body as a whole apart");
  if (!geometry) return std::nullopt;
  if (plan.suspended_modes < 0 && !study.supports.empty()) return std::nullopt;
  const auto found = plan.suspended_modes > 0
                         ? identification::stated_suspension(fit, geometry->outputs,
                                                             geometry->inputs, plan.suspended_modes)
                         : identification::suspension(fit, geometry->outputs, geometry->inputs);
  geometry->suspended = found.modes;
  // Thesis 5.2.6 is its remedy against blended modes. For other modes it loses information of the
  // actuators.
  geometry->pairs_first = plan.gain != "thesis" || plan.suspended_modes < 0;
  geometry->bending = found.bending;
  return geometry;
}

// The flexible shapes at the side with more channels. Each shape has its own scale there, so the
// result does not depend on the gains.
priors::MeasuredShapes shapes_of_one_side(const IdentifiedModel& model,
                                          const identification::GainPrior& prior) {
  const auto& fit = model.found.fit;
  const bool sensors = prior.outputs.count() >= prior.inputs.count();
  const Eigen::MatrixXd values =
      sensors ? fit.model.output_shapes : fit.model.input_shapes.transpose();
  const Eigen::MatrixXd noise = sensors ? fit.output_std : fit.input_std.transpose();
  std::vector<Eigen::Index> modes;
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    if (noise.col(m).allFinite() && noise.col(m).minCoeff() > 0.0) modes.push_back(m);
  }
  return {sensors ? prior.outputs : prior.inputs, fit.model.frequency_hz(modes),
          values(Eigen::all, modes), noise(Eigen::all, modes)};
}

// Corrects the simulation by the measured shapes, and sets its remaining errors.
void learn(const stage::Solution& solution, const IdentifiedModel& model,
           identification::GainPrior& prior) {
  constexpr Eigen::Index kFewestPlaces = 3;  // as for an interpolation
  const auto shapes = shapes_of_one_side(model, prior);
  if (shapes.places.count() < kFewestPlaces || shapes.mode_count() == 0) return;
  const auto learned =
      priors::learned_corrections(shapes, prior.basis, stage::corrections(solution));
  const auto& modes = learned.likeliest.modes;
  prior.basis = priors::corrected_basis(prior.basis, modes);
  prior.outputs.shapes = (prior.outputs.shapes * modes.turn).eval();
  prior.inputs.shapes = (prior.inputs.shapes * modes.turn).eval();
  prior.residual = learned.likeliest.errors.prior;
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
  const auto sites = channel_sites(study, solution.model);
  const auto places = [&](const std::vector<modal::MeasuredChannel>& channels) {
    std::vector<ChannelSite> chosen;
    for (const auto& channel : channels) {
      chosen.push_back(sites[static_cast<std::size_t>(index_of(sites, channel.name))]);
    }
    return places_at(chosen, solution.modes);
  };
  identification::GainPrior prior{
      places(model.seen.outputs), places(model.seen.inputs), priors::modal_basis(simulation), {}};
  learn(solution, model, prior);
  return prior;
}

// True if the scale of a flexible mode was not found.
bool is_untold(const identification::GainMatch& match, Eigen::Index rigid_count) {
  return std::any_of(match.modes.begin() + rigid_count, match.modes.end(), [](const auto& mode) {
    return mode.by == identification::MatchedBy::nothing;
  });
}

}  // namespace

identification::GainMatch matched(const study::Study& study, const stage::Solution* solution,
                                  IdentifiedModel& model, stage::Work& work) {
  const auto plan = identification_plan(study);
  model.pairs = pairs_of(plan, model.seen);
  if (needs_simulation(model)) {
    if (solution != nullptr) {
      add_simulated_pairs(study, *solution, model);
    } else {
      const stage::Solution own = stage::solved(study, work);
      add_simulated_pairs(study, own, model);
    }
  }
  identification::GainMatchOptions options;
  options.pairs = model.pairs;
  options.rule =
      plan.gain == "thesis" ? identification::GainRule::thesis : identification::GainRule::tied;
  if (plan.gain_errors == "sensors") options.fault = identification::GainFault::outputs;
  if (plan.gain_errors == "actuators") options.fault = identification::GainFault::inputs;
  model.corrects_gains = plan.gain_errors != "none";
  options.geometry = rigid_geometry(study, model);
  const auto& fit = model.found.fit;
  auto match = identification::gain_match(fit, model.seen.outputs, model.seen.inputs, options);
  if (solution == nullptr || !is_untold(match, fit.model.rigid_count)) return match;
  options.prior = gain_prior(study, *solution, model);
  return identification::gain_match(fit, model.seen.outputs, model.seen.inputs, options);
}

identification::RigidMotion rigid_motion(Eigen::Index rigid_count) {
  return rigid_count == 2 ? identification::RigidMotion::beam : identification::RigidMotion::plate;
}

}  // namespace chladni::steps
