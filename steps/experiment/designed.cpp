#include "steps/designed.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "stage/at_channels.h"
#include "stage/faces.h"
#include "steps/identification.h"

namespace chladni::steps {
namespace {

using identification::DesignModel;

DesignModel model_of(const study::Study& study, const stage::Solution& solution,
                     stage::Work& work) {
  DesignModel model;
  model.model =
      work.timed("reduction", [&] { return stage::at_channels_and_drives(study, solution); });
  for (const auto& sensor : study.sensors) model.kinds.push_back(kind_of(sensor.quantity));
  const auto& modes = solution.modes;
  model.largest.resize(modes.mode_count());
  for (Eigen::Index k = 0; k < model.largest.size(); ++k) {
    model.largest(k) =
        modes.shapes.col(k).reshaped(3, modes.dof_count() / 3).colwise().norm().maxCoeff();
  }
  return model;
}

// White noise of the sensors with that of their steps [unit of the sensors].
Eigen::VectorXd noise_of(const study::Study& study) {
  const auto& plan = *study.experiment;
  const double steps = plan.quantisation / std::sqrt(12.0);
  return Eigen::VectorXd::Constant(std::ssize(study.sensors), std::hypot(plan.noise, steps));
}

void set_band(const study::ExperimentPlan& plan, double period_s, double& low_hz, double& high_hz) {
  low_hz = plan.low_hz > 0.0 ? plan.low_hz : 1.0 / period_s;
  high_hz = plan.high_hz > 0.0 ? plan.high_hz : 0.125 * plan.sample_rate_hz;
}

recordings::ExcitedLines lines_of(const study::ExperimentPlan& plan) {
  using recordings::ExcitedLines;
  if (plan.lines == "all") return ExcitedLines::all;
  return plan.lines == "odd" ? ExcitedLines::odd : ExcitedLines::odd_with_detection;
}

identification::DesignPlan multisine_plan(const study::Study& study,
                                          const DesignedExperiment& found) {
  const auto& rig = *study.experiment;
  const auto& design = *study.design;
  return {.sample_time_s = 1.0 / rig.sample_rate_hz,
          .low_hz = found.low_hz,
          .high_hz = found.high_hz,
          .lines = lines_of(rig),
          .scheme = rig.inputs == "orthogonal" ? recordings::InputScheme::orthogonal
                                               : recordings::InputScheme::one_at_a_time,
          .sensor_noise = found.sensor_noise,
          .noise_ratio = rig.noise_ratio,
          .process_noise_n = rig.process_noise,
          .force_limit_n = design.force_limit(),
          .stroke_limit_m = design.stroke.value_or(identification::kNoLimit),
          .margin = design.margin,
          .frequency_std_hz = design.frequency_deviation.value_or(identification::kNoLimit),
          .damping_std = design.damping_deviation,
          .longest_s = design.longest,
          .longest_period_s = design.longest_period,
          .realisations = design.realisations,
          .simulation_error = design.simulation_error,
          .crest_iterations = design.phases == "low_crest" ? 100 : 0};
}

identification::HammerPlan hammer_plan(const study::Study& study, const DesignedExperiment& found) {
  const auto& design = *study.design;
  return {.sample_time_s = 1.0 / study.experiment->sample_rate_hz,
          .low_hz = found.low_hz,
          .high_hz = found.high_hz,
          .sensor_noise = found.sensor_noise,
          .force_limit_n = design.force_limit(),
          .pulse_s = design.pulse.value_or(0.0),
          .frequency_std_hz = design.frequency_deviation.value_or(identification::kNoLimit),
          .damping_std = design.damping_deviation,
          .longest_s = design.longest,
          .longest_record_s = design.longest_period};
}

void design_hammer(const study::Study& study, const stage::Solution& solution,
                   const DesignModel& model, DesignedExperiment& found) {
  require(study.experiment->noise_ratio == 0.0,
          "experiment.noise_ratio: what a blow moves depends on where it falls; expected noise");
  const auto& body = solution.model.body;
  const auto faces = stage::faces_of(study, body, study.design->on, "design.on");
  found.notes.insert(found.notes.end(), faces.notes.begin(), faces.notes.end());
  const placement::Sampler sampler(body, solution.modes, {});
  const auto surface = stage::surface_on(sampler, faces);
  found.hammer =
      identification::hammer_design(model, surface.sites.shapes, hammer_plan(study, found));
  found.points = placement::part(surface.sites, found.hammer->points);
}

}  // namespace

void require_design(const study::Study& study) {
  require(study.design.has_value(),
          "the study has no [design]; expected one, such as [design] force = \"5 N\"");
  require(study.experiment.has_value(),
          "the study has no [experiment]; expected one that states the rig's sample_rate and its "
          "sensors' noise, such as [experiment] noise = \"2 nm\"");
  require(!study.sensors.empty(), "an experiment needs a sensor or more");
  require(study.design->kind == "hammer" || !study.actuators.empty(),
          "an experiment needs an actuator or more");
}

DesignedExperiment designed(const study::Study& study, const stage::Solution& solution,
                            stage::Work& work) {
  require_design(study);
  const auto model = model_of(study, solution, work);
  DesignedExperiment found;
  found.sensor_noise = noise_of(study);
  found.rigid_count = model.model.rigid_count;
  set_band(*study.experiment, study.design->longest_period, found.low_hz, found.high_hz);
  if (study.design->kind == "hammer") {
    work.timed("design", [&] {
      design_hammer(study, solution, model, found);
      return 0;
    });
  } else {
    const auto progress = work.progress();
    found.multisine = work.timed("design", [&] {
      return identification::experiment_design(model, multisine_plan(study, found), work.seed(),
                                               progress);
    });
  }
  work.clear_progress();
  return found;
}

std::string command_unit(const study::Study& study) {
  return study.design->force_per_volt ? "V" : "N";
}

double command_per_newton(const study::Study& study) {
  return 1.0 / study.design->force_per_volt.value_or(1.0);
}

recordings::TimeData excitation_of(const study::Study& study,
                                   const identification::ExperimentDesign& design) {
  recordings::TimeData data;
  data.sample_time_s = design.sample_time_s;
  data.period = design.period;
  for (const auto& actuator : study.actuators) {
    auto& channel = data.inputs.emplace_back();
    channel.name = actuator.name;
    channel.direction = actuator.direction;
    channel.unit = command_unit(study);
  }
  const double scale = command_per_newton(study);
  for (std::size_t r = 0; r < design.realisations.size(); ++r) {
    const auto& inputs = design.realisations[r].inputs;
    for (std::size_t e = 0; e < inputs.size(); ++e) {
      data.records.push_back({.outputs = Eigen::MatrixXd(inputs[e].rows(), 0),
                              .inputs = scale * inputs[e],
                              .references = Eigen::MatrixXd(inputs[e].rows(), 0),
                              .experiment = static_cast<int>(e),
                              .realisation = static_cast<int>(r)});
    }
  }
  return data;
}

Eigen::MatrixXd sequence_of(const study::Study& study,
                            const identification::ExperimentDesign& design, std::size_t realisation,
                            std::size_t experiment) {
  require(
      realisation < design.realisations.size() &&
          experiment < design.realisations[realisation].inputs.size(),
      fmt::format("there is no experiment {} of realisation {}; expected one of {} realisations "
                  "with {} experiments each, counted from 0",
                  experiment, realisation, design.realisations.size(),
                  design.realisations.empty() ? 0 : design.realisations.front().inputs.size()));
  return command_per_newton(study) *
         identification::sequence(design, design.realisations[realisation].inputs[experiment]);
}

}  // namespace chladni::steps
