// The best filter: that of a virtual rig's own modes.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "recordings/virtual_experiment.h"
#include "stage/at_channels.h"
#include "steps/observer_replay.h"
#include "steps/predicted.h"

namespace chladni::steps {
namespace {

// The rig with the channels of the observer, in their order: sensors and judges; actuators and
// places of forces.
study::Study on_channels(const study::Study& study, const Observer& observer,
                         const study::Study& rig) {
  const auto& model = identified_of(*observer.shapes);
  const auto channel = [&](const std::vector<study::Channel>& all, const std::string& name) {
    const auto at = index_of(all, name);
    require(at >= 0, fmt::format("{}: there is no channel \"{}\"; expected every sensor and "
                                 "actuator of {}",
                                 rig.file.string(), name, study.file.string()));
    return all[static_cast<std::size_t>(at)];
  };
  auto result = rig;
  result.sensors.clear();
  result.actuators.clear();
  for (const auto& one : model.seen.outputs) {
    result.sensors.push_back(channel(rig.sensors, one.name));
  }
  const auto names = observer.names();
  for (auto k = std::ssize(names) - observer.judges; k < std::ssize(names); ++k) {
    result.sensors.push_back(channel(rig.sensors, names[static_cast<std::size_t>(k)]));
  }
  for (const auto& one : model.seen.inputs) {
    result.actuators.push_back(channel(rig.actuators, one.name));
  }
  std::size_t forces = 0;
  for (const auto& plan : study.observer->disturbances) {
    if (plan.kind != "force") continue;
    study::Channel force;
    force.name = plan.name;
    force.at = plan.at;
    force.direction = observer.force_directions.at(forces++);
    force.quantity = "force";
    result.actuators.push_back(force);
  }
  return result;
}

double delay_of(const study::Study& rig) {
  if (!rig.experiment) return 0.0;
  const auto& plan = *rig.experiment;
  return plan.controlled.empty() ? plan.delay : std::max(plan.delay, 1.0 / plan.sample_rate_hz);
}

modal::KalmanFilter filter_of(const study::Study& study, const Observer& observer,
                              const study::Study& rig, stage::Work& work) {
  const auto part = work.part("truth: ");
  const auto channels = on_channels(study, observer, rig);
  const stage::Solution solution = stage::solved(channels, work);
  const auto modes = recordings::in_view(stage::at_channels(channels, solution));
  std::vector<modal::OutputChannel> outputs;
  for (const auto& sensor : channels.sensors) {
    outputs.push_back({sensor.name, kind_of(sensor.quantity)});
  }
  auto plant = modal::control_model(modes, outputs, study::names_of(channels.actuators));
  const auto& system = observer.filter.system;
  plant.input_delay.head(system.known).setConstant(delay_of(rig));
  return modal::kalman_filter(modal::disturbed_model(plant, system.known, observer.disturbances,
                                                     system.sensor_rms, observer.sample_time_s));
}

}  // namespace

std::optional<modal::KalmanFilter> true_filter(const study::Study& study, const Observer& observer,
                                               stage::Work& work) {
  const auto& path = study.observer->truth;
  if (path.empty()) return std::nullopt;
  const auto rig = study::read_study(path, work.choices().allowed);
  if (observer.places.floor.size() > 0) {
    work.note(
        "the filter that knows the truth is left out: nothing says how the floor moves its "
        "modes");
    return std::nullopt;
  }
  if (rig.experiment && rig.experiment->structure != "study") {
    work.note(path.string() +
              ": the filter that knows the truth is left out: the rig is a chain "
              "of rigid bodies, which has no modes of the study");
    return std::nullopt;
  }
  return filter_of(study, observer, rig, work);
}

}  // namespace chladni::steps
