#include "app/identification.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

#include "app/faces.h"
#include "app/interpolation.h"
#include "app/placement.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "identification/delay_scan.h"
#include "identification/matrix_fraction.h"
#include "identification/model_error.h"

namespace chladni::app {
namespace {

constexpr double kAssumedModelError = 0.01;  // where no variance is stated
constexpr double kLargestMode = 0.15;        // deviation of ln f between a mode and its simulation

IdentificationPlan plan_of(const Study& study) {
  return study.identification.value_or(IdentificationPlan{});
}

// Springs to ground and supports hold it; what hangs on it does not.
bool is_held(const Study& study) {
  return !study.supports.empty() ||
         std::any_of(study.attachments.begin(), study.attachments.end(), [](const auto& one) {
           return std::holds_alternative<fem::GroundSpring>(one.what) ||
                  std::holds_alternative<fem::GroundTorsionSpring>(one.what);
         });
}

identification::FitDataOptions data_options(const IdentificationPlan& plan,
                                            const modal::FrfSet& set) {
  identification::FitDataOptions options{.low_hz = plan.low_hz, .high_hz = plan.high_hz};
  if (plan.weighting == "inverse_magnitude") {
    options.weighting = identification::Weighting::inverse_magnitude;
  }
  options.cut_off_db = plan.cut_off_db;
  options.model_error = plan.model_error.value_or(set.variance.empty() ? kAssumedModelError : 0.0);
  return options;
}

identification::DelayOf delay_of(const IdentificationPlan& plan) {
  if (plan.delay_of == "sensors") return identification::DelayOf::outputs;
  if (plan.delay_of == "actuators") return identification::DelayOf::inputs;
  return identification::DelayOf::all;
}

identification::IdentificationOptions fit_options(const IdentificationPlan& plan,
                                                  const Study& study, Run& run) {
  identification::IdentificationOptions options;
  options.modes = plan.modes;
  options.rigid_count = plan.rigid_body_modes;
  if (plan.rigid_body_modes < 0 && is_held(study)) options.rigid_count = 0;
  if (plan.damping == "general") options.fit.damping = identification::Damping::general;
  options.fit.delay = plan.delay;
  options.fit.delay_of = delay_of(plan);
  options.fit.residual = plan.residual;
  options.fit.keep_best = run.options().keep_best;
  options.fit.progress = run.talk().progress();
  return options;
}

// Seen along its own direction: a sensor and an actuator on both faces of a plate are one place.
std::vector<modal::MeasuredChannel> along(std::vector<modal::MeasuredChannel> channels) {
  for (auto& one : channels) {
    *one.position -= one.direction * one.direction.dot(*one.position);
  }
  return channels;
}

std::vector<identification::CollocatedPair> pairs_of(const IdentificationPlan& plan,
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
                               const std::vector<Channel>& channels,
                               const std::vector<mesh::Site>& sites, const modal::Modes& modes) {
  const auto all = shapes_at(channels, sites, modes);
  std::vector<Eigen::Index> rows;
  for (const auto& one : measured) {
    rows.push_back(index_of(channels, one.name));
  }
  return all(rows, Eigen::all);
}

double alike(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::pow(a.dot(b), 2) / std::max(1e-300, a.squaredNorm() * b.squaredNorm());
}

// The mode of the simulation that a fitted mode is most like, on both sides and in frequency.
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

// What the simulation says of the two places of each pair, mode by mode.
void add_simulated_pairs(const Study& study, const Solution& solution, IdentifiedModel& model) {
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

void add_errors(IdentifiedModel& model) {
  const auto& data = model.data;
  const Eigen::MatrixXcd fitted = identification::responses(model.found.fit, data.frequency_hz);
  model.error.resize(data.outputs, data.inputs);
  model.noise.resize(data.outputs, data.inputs);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::ArrayXd there = (data.weight.col(e).array() > 0.0).cast<double>();
    const double size = data.value.col(e).norm();
    const auto i = e % data.outputs;
    const auto j = e / data.outputs;
    const Eigen::ArrayXd wrong = (data.value.col(e) - fitted.col(e)).cwiseAbs().array() * there;
    model.error(i, j) = wrong.matrix().norm() / size;
    model.noise(i, j) =
        (there / data.weight.col(e).array().max(1e-300) * there).matrix().norm() / size;
  }
}

// Where all channels move along z and are told apart, the rigid-body modes have a geometry.
std::optional<identification::RigidGeometry> rigid_geometry(const IdentifiedModel& model) {
  const auto rigid = model.found.fit.model.rigid_count;
  const auto& seen = model.seen;
  if (rigid != 2 && rigid != 3) return std::nullopt;
  const auto rows = [&](const std::vector<modal::MeasuredChannel>& channels) {
    Eigen::MatrixX3d places(static_cast<Eigen::Index>(channels.size()), 3);
    Eigen::VectorXd sign(places.rows());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      places.row(static_cast<Eigen::Index>(i)) = channels[i].position->transpose();
      sign(static_cast<Eigen::Index>(i)) = channels[i].direction.z();
    }
    return Eigen::MatrixXd(sign.asDiagonal() *
                           identification::rigid_directions(places, rigid_motion(rigid)));
  };
  const auto along_z = [](const auto& one) { return std::abs(one.direction.z()) > 0.999; };
  if (!std::all_of(seen.outputs.begin(), seen.outputs.end(), along_z) ||
      !std::all_of(seen.inputs.begin(), seen.inputs.end(), along_z)) {
    return std::nullopt;
  }
  identification::RigidGeometry geometry{rows(seen.outputs), rows(seen.inputs), {}, 0.0};
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> outputs(geometry.outputs);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> inputs(geometry.inputs);
  if (std::max(outputs.rank(), inputs.rank()) < rigid) return std::nullopt;
  return geometry;
}

// What the simulation says of the scale between sensors and actuators where no pair does.
identification::GainPrior gain_prior(const Study& study, const Solution& solution,
                                     const IdentifiedModel& model) {
  const auto on = study.interpolation ? study.interpolation->on : FacePlan{};
  const auto faces = faces_of(study, solution.model.body, on, "interpolation.on");
  const placement::Sampler sampler(solution.model.body, solution.modes, {faces.direction, 0.0});
  const auto surface = surface_on(sampler, faces);
  priors::Simulation simulation;
  simulation.frequency_hz = solution.modes.frequency_hz;
  simulation.surface = {surface.sites.position, directions_on(surface.sites, faces.direction),
                        surface.sites.shapes};
  simulation.area = surface.sites.area;
  const auto sites = channel_sites(study, solution.model);
  const auto places = [&](const std::vector<modal::MeasuredChannel>& channels) {
    std::vector<ChannelSite> chosen;
    for (const auto& channel : channels) {
      chosen.push_back(sites[static_cast<std::size_t>(index_of(sites, channel.name))]);
    }
    return places_at(chosen, solution.modes);
  };
  return {
      places(model.seen.outputs), places(model.seen.inputs), priors::modal_basis(simulation), {}};
}

identification::GainMatch matched(const Study& study, const Solution* solution,
                                  IdentifiedModel& model, Run& run) {
  const auto plan = plan_of(study);
  model.pairs = pairs_of(plan, model.seen);
  if (needs_simulation(model)) {
    if (solution != nullptr) {
      add_simulated_pairs(study, *solution, model);
    } else {
      const Solution own = solved(study, run);
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
  options.geometry = rigid_geometry(model);
  if (solution != nullptr) options.prior = gain_prior(study, *solution, model);
  return identification::gain_match(model.found.fit, model.seen.outputs, model.seen.inputs,
                                    options);
}

}  // namespace

identification::RigidMotion rigid_motion(Eigen::Index rigid_count) {
  return rigid_count == 2 ? identification::RigidMotion::beam : identification::RigidMotion::plate;
}

identification::FitData fit_data_of(const Study& study, const IdentifiedModel& model,
                                    const modal::FrfSet& set) {
  return identification::fit_data(set, data_options(plan_of(study), model.seen));
}

namespace {

identification::Identified found(const IdentificationPlan& plan, const Study& study,
                                 const identification::FitData& data, Run& run) {
  const auto options = fit_options(plan, study, run);
  if (plan.method != "thesis") return identification::identified(data, options);
  require(plan.modes > 0, study.file.string() +
                              ": the thesis' path does not find the number of modes; expected "
                              "identification.modes");
  identification::ThesisOptions thesis{.modes = plan.modes};
  thesis.rigid_count = std::max<Eigen::Index>(0, options.rigid_count);
  thesis.residual = plan.residual;
  thesis.progress = options.fit.progress;
  identification::Identified result;
  result.fit = identification::thesis_fit(data, thesis);
  return result;
}

// The data as the fit has seen them.
void take_out_drift(IdentifiedModel& model) {
  if (!model.found.drift) return;
  const auto& shift = model.found.drift->shift;
  model.data = identification::without_drift(model.data, model.found.fit, shift);
  if (model.drift.size() == 0) model.drift.setZero(shift.size());
  model.drift += shift;
}

// What a study states is the most that the model may be off; once its modes are known the data say
// how much it is, and the fit may come as near as that.
bool may_come_nearer(const IdentificationPlan& plan, const IdentifiedModel& model) {
  constexpr Eigen::Index kMany = 200;  // responses that are fitted by their combinations
  const auto& fit = model.found.fit;
  const bool single = std::none_of(fit.groups.begin(), fit.groups.end(),
                                   [](const auto& group) { return group.size > 1; });
  return !model.seen.variance.empty() && plan.weighting == "variance" && plan.method != "thesis" &&
         plan.damping == "modal" && plan.model_error.value_or(0.0) > 0.0 && single &&
         model.data.response_count() <= kMany && fit.converged;
}

// The errors of a model go together along the lines and do not average out as noise does: the
// deviations stay those of the first fit, and so do the delays, which phases of complex modes would
// pass for.
void come_nearer(const IdentificationPlan& plan, const Study& study, IdentifiedModel& model,
                 Run& run) {
  constexpr int kRounds = 2;
  auto how = fit_options(plan, study, run).fit;
  how.delay = false;
  auto noise_only = data_options(plan, model.seen);
  noise_only.model_error = 0.0;
  const auto delays = identification::response_delays(model.found.fit);
  const auto data =
      identification::undelayed(identification::fit_data(model.seen, noise_only), delays);
  auto fit = model.found.fit;
  for (int round = 0; round < kRounds; ++round) {
    fit.delay_s = 0.0;
    fit.channel_delay_s.resize(0);
    const Eigen::MatrixXcd fitted = identification::responses(fit, data.frequency_hz);
    model.model_error = identification::remaining_model_error(data, fitted, *plan.model_error);
    fit = identification::refitted(
        identification::with_model_error(data, fitted, model.model_error), fit, how);
  }
  identification::take_values(fit, model.found.fit);
}

std::string drift_warning(const IdentifiedModel& model) {
  const auto name = [&](Eigen::Index e) {
    return model.seen.outputs[static_cast<std::size_t>(e % model.data.outputs)].name + "/" +
           model.seen.inputs[static_cast<std::size_t>(e / model.data.outputs)].name;
  };
  Eigen::Index low = 0;
  Eigen::Index high = 0;
  const double least = model.drift.minCoeff(&low);
  const double most = model.drift.maxCoeff(&high);
  return fmt::format(
      "the resonances of {} lie {:.0f} millionths of their frequency above those of {}: the "
      "structure changed between the measurements; the responses are fitted as if it had not",
      name(high), 1e6 * (most - least), name(low));
}

// Of the study's responses, as near to them as their noise and the study's model error allow.
IdentifiedModel fitted_model(const IdentificationPlan& plan, const Study& study, Run& run) {
  IdentifiedModel model;
  model.measured = run.timed("read", [&] { return measured_frfs(study, run); });
  model.seen = modal::part(model.measured.all, model.measured.outputs, model.measured.inputs);
  model.data = identification::fit_data(model.seen, data_options(plan, model.seen));
  model.found = run.timed("fit", [&] { return found(plan, study, model.data, run); });
  take_out_drift(model);
  const auto stopped = [&] { return run.options().keep_best && interrupted(); };
  if (!stopped() && may_come_nearer(plan, model)) {
    come_nearer(plan, study, model, run);
  } else if (!stopped() && model.seen.variance.empty() && plan.weighting == "variance") {
    // The noise is better known once the resonances are.
    model.data = identification::reweighted(
        model.data, identification::responses(model.found.fit, model.data.frequency_hz),
        data_options(plan, model.seen));
    model.found = run.timed("fit again", [&] { return found(plan, study, model.data, run); });
    take_out_drift(model);
  }
  if (stopped()) {
    forget_interrupt();
    run.talk().warn("the fit was stopped by Ctrl-C: its best so far is written");
  }
  return model;
}

}  // namespace

IdentifiedModel identified(const Study& study, const Solution* solution, Run& run) {
  const auto plan = plan_of(study);
  auto model = fitted_model(plan, study, run);
  run.talk().clear_progress();
  if (model.drift.size() > 0) run.talk().warn(drift_warning(model));
  for (const auto& note : model.found.fit.notes) run.talk().warn(note);
  model.match = run.timed("gains", [&] { return matched(study, solution, model, run); });
  for (const auto& warning : model.match.warnings) run.talk().warn(warning);
  add_errors(model);
  if (plan.stabilisation > 0) {
    model.stabilisation = run.timed("stabilisation", [&] {
      const auto data =
          identification::undelayed(model.data, identification::response_delays(model.found.fit));
      return identification::stabilisation(
          data, plan.stabilisation, model.found.fit.model.rigid_count > 0, run.talk().progress());
    });
  }
  return model;
}

}  // namespace chladni::app
