// [experiment] of a study: the virtual experiment.
#include <algorithm>

#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {

std::string sensor_unit(const Study& study) {
  if (study.sensors.empty()) return "m";
  const auto& first = study.sensors.front().quantity;
  for (const auto& sensor : study.sensors) {
    if (sensor.quantity != first) return "";
  }
  if (first == "velocity") return "m/s";
  return first == "acceleration" ? "m/s^2" : "m";
}

namespace {

void read_noise(TableReader& table, const Study& study, ExperimentPlan& plan) {
  const auto unit = sensor_unit(study);
  for (const auto* key : {"noise", "quantisation"}) {
    if (unit.empty() && table.has(key)) {
      table.wrong(*table.find(key), table.name(key) +
                                        ": the sensors measure different quantities; expected "
                                        "noise_ratio instead");
      return;
    }
  }
  if (!unit.empty()) {
    plan.noise = table.quantity("noise", unit, Sign::not_negative).value_or(0.0);
    plan.quantisation = table.quantity("quantisation", unit, Sign::not_negative).value_or(0.0);
  }
  if (plan.noise > 0.0 && plan.noise_ratio > 0.0) {
    table.wrong(*table.find("noise_ratio"),
                "experiment has noise and noise_ratio; expected one of them");
  }
}

void read_band(TableReader& table, ExperimentPlan& plan) {
  if (const auto band = table.quantities("band", "Hz", 2, Sign::not_negative)) {
    plan.low_hz = (*band)(0);
    plan.high_hz = (*band)(1);
    if (!(plan.low_hz < plan.high_hz) || plan.high_hz > 0.5 * plan.sample_rate_hz) {
      table.wrong(
          *table.find("band"),
          "experiment.band: expected two frequencies, ascending, up to half of sample_rate");
    }
  }
}

void read_loop(TableReader& table, const Study& study, ExperimentPlan& plan) {
  plan.controlled = table.texts("controlled");
  refuse_strangers(table, "controlled", "actuator of the study", plan.controlled,
                   names_of(study.actuators));
  if (!plan.controlled.empty() && plan.bandwidth_hz == 0.0 && !table.has("bandwidth")) {
    table.missing("bandwidth", "\"10 Hz\": controlled actuators need one");
  }
}

void read_cubic_spring(TableReader& table, const Study& study, ExperimentPlan& plan) {
  auto spring = table.table("cubic_spring");
  if (!spring) return;
  plan.cubic_stiffness = spring->required_quantity("stiffness", "N/m^3");
  plan.cubic_sensor = spring->required_text("sensor");
  plan.cubic_actuator = spring->required_text("actuator");
  refuse_strangers(*spring, "sensor", "sensor of the study", {plan.cubic_sensor},
                   names_of(study.sensors));
  refuse_strangers(*spring, "actuator", "actuator of the study", {plan.cubic_actuator},
                   names_of(study.actuators));
  spring->refuse_unknown();
}

}  // namespace

void read_experiment(TableReader& root, const StudyFolder& folder, Study& study) {
  auto table = root.table("experiment");
  if (!table) return;
  auto& plan = study.experiment.emplace();
  experiment_schema().read(*table, plan);
  read_band(*table, plan);
  read_noise(*table, study, plan);
  read_loop(*table, study, plan);
  read_cubic_spring(*table, study, plan);
  plan.excitation = read_path(*table, folder, "excitation", study);
  table->refuse_unknown();
}

}  // namespace chladni::study
