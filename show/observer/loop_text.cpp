// The loop on an observer's estimate as text and JSON.
#include <fmt/format.h>

#include <cmath>

#include "base/percent.h"
#include "show/observer.h"

namespace chladni::show {
namespace {

// NaN where no model was drawn, or one of them is unstable.
double worst_margin(const steps::LoopCase& one, int draws) {
  return draws > 0 && one.stable_draws == draws ? one.worst_margin : NAN;
}

std::string margin_text(double margin) {
  return std::isfinite(margin) ? fmt::format("{:.2f}", margin) : "-";
}

std::string row(const char* name, const steps::LoopCase& one, int draws) {
  if (!one.stable) return fmt::format("{:<20} unstable on the identified model\n", name);
  const double worst = one.worst_rms.empty() ? NAN : one.worst_rms.front();
  return fmt::format("{:<20}{:>12}{:>10.2f}{:>10}{:>14}{:>16}\n", name,
                     length_text(one.rms.front()), one.modulus_margin,
                     draws > 0 ? fmt::format("{}/{}", one.stable_draws, draws) : "-",
                     margin_text(worst_margin(one, draws)), length_text(worst));
}

std::string loop_verdict(const steps::LoopTrial& trial) {
  const auto& estimate = trial.on_estimate;
  const auto& sensors = trial.on_sensors;
  if (!estimate.stable) return "The loop on the estimate is unstable: it does not pay.\n";
  if (!sensors.stable) return "Only the loop on the estimate is stable.\n";
  const double gain = 1.0 - estimate.rms.front() / sensors.rms.front();
  if (gain > 0.0) {
    return fmt::format("{}: feedback on the estimate leaves {} less motion than on the sensors.\n",
                       trial.points.front(), percent(gain));
  }
  return fmt::format(
      "{}: feedback on the estimate leaves {} more motion than on the sensors: it "
      "does not pay.\n",
      trial.points.front(), percent(-gain));
}

io::Json list(const std::vector<double>& values) {
  io::JsonArray array;
  for (const double value : values) array.emplace_back(value);
  return array;
}

io::Json case_json(const steps::LoopCase& one, int draws) {
  return io::JsonObject{{"stable", one.stable},
                        {"rms_m", list(one.rms)},
                        {"modulus_margin", one.stable ? one.modulus_margin : NAN},
                        {"stable_draws", one.stable_draws},
                        {"worst_modulus_margin", worst_margin(one, draws)},
                        {"median_rms_m", list(one.median_rms)},
                        {"worst_rms_m", list(one.worst_rms)}};
}

}  // namespace

std::string loop_text(const steps::LoopTrial& trial) {
  return "\n" + loop_verdict(trial) +
         fmt::format("{:<20}{:>12}{:>10}{:>10}{:>14}{:>16}   {} axes, {:.4g} Hz\n", "feedback on",
                     "rms", "margin", "stable", "worst margin", "worst rms", trial.axes,
                     trial.bandwidth_hz) +
         row("sensors", trial.on_sensors, trial.draws) +
         row("estimate", trial.on_estimate, trial.draws) +
         fmt::format("no loop             {:>12}\n", length_text(trial.open_rms.front()));
}

io::Json loop_json(const steps::LoopTrial& trial) {
  io::JsonArray points;
  for (const auto& point : trial.points) points.emplace_back(point);
  return io::JsonObject{{"points", points},
                        {"axes", static_cast<long long>(trial.axes)},
                        {"bandwidth_hz", trial.bandwidth_hz},
                        {"delay_s", trial.delay_s},
                        {"draws", trial.draws},
                        {"open_rms_m", list(trial.open_rms)},
                        {"on_sensors", case_json(trial.on_sensors, trial.draws)},
                        {"on_estimate", case_json(trial.on_estimate, trial.draws)},
                        {"notes", io::Json::texts(trial.notes)}};
}

}  // namespace chladni::show
