// Measurement, experiment and identification of a study, in SI units.
#include "show/solution/study_measured_json.h"

namespace chladni::show {

io::Json measurement_json(const study::MeasurementPlan& plan) {
  return io::JsonObject{{"frf", plan.frf.filename().string()},
                        {"time", plan.time.filename().string()},
                        {"shapes", plan.shapes.filename().string()},
                        {"truth", plan.truth.filename().string()},
                        {"noise", plan.noise},
                        {"modes", plan.modes},
                        {"hold_out", io::Json::texts(plan.hold_out)},
                        {"source", plan.source}};
}

io::Json experiment_json(const study::ExperimentPlan& plan) {
  return io::JsonObject{{"structure", plan.structure},
                        {"sample_rate_hz", plan.sample_rate_hz},
                        {"samples", plan.samples},
                        {"periods", plan.periods},
                        {"realisations", plan.realisations},
                        {"warm_up", plan.warm_up},
                        {"amplitude_n", plan.amplitude},
                        {"band_hz", io::JsonArray{plan.low_hz, plan.high_hz}},
                        {"lines", plan.lines},
                        {"inputs", plan.inputs},
                        {"noise", plan.noise},
                        {"noise_ratio", plan.noise_ratio},
                        {"process_noise_n", plan.process_noise},
                        {"quantisation", plan.quantisation},
                        {"delay_s", plan.delay},
                        {"compensate", plan.compensate},
                        {"cubic_stiffness_n_per_m3", plan.cubic_stiffness},
                        {"cubic_sensor", plan.cubic_sensor},
                        {"cubic_actuator", plan.cubic_actuator},
                        {"controlled", io::Json::texts(plan.controlled)},
                        {"bandwidth_hz", plan.bandwidth_hz},
                        {"leaves", plan.leaves_time ? "time" : "frf"}};
}

io::Json identification_json(const study::IdentificationPlan& plan) {
  io::JsonArray pairs;
  for (const auto& [sensor, actuator] : plan.pairs) {
    pairs.push_back(io::JsonObject{{"sensor", sensor}, {"actuator", actuator}});
  }
  return io::JsonObject{
      {"band_hz", io::JsonArray{plan.low_hz, plan.high_hz}},
      {"method", plan.method},
      {"damping", plan.damping},
      {"weighting", plan.weighting},
      {"cut_off_db", plan.cut_off_db},
      {"clip_db", plan.clip_db},
      {"fraction_degree", plan.fraction_degree},
      {"sanathanan_koerner", plan.sanathanan_koerner},
      {"levenberg_marquardt", plan.levenberg_marquardt},
      {"modal_iterations", plan.modal_iterations},
      {"model_error", plan.model_error ? io::Json(*plan.model_error) : io::Json()},
      {"modes", plan.modes},
      {"rigid_body_modes", plan.rigid_body_modes},
      {"suspended_modes", plan.suspended_modes},
      {"delay", plan.delay},
      {"delay_of", plan.delay_of},
      {"residual", plan.residual},
      {"unit", plan.unit},
      {"pairs", pairs},
      {"pairs_within_m", plan.pairs_within},
      {"gain", plan.gain},
      {"gain_errors", plan.gain_errors},
      {"stabilisation", plan.stabilisation}};
}

}  // namespace chladni::show
