// An identified model as a table, JSON and files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/percent.h"
#include "io/csv.h"
#include "io/mat.h"
#include "modal/state_space.h"
#include "show/control_models.h"
#include "show/figures/stored_curves.h"
#include "show/identification.h"
#include "show/identification/complex_text.h"
#include "show/modes_uff.h"
#include "show/readable.h"
#include "show/rigid_body.h"
#include "steps/identification.h"

namespace chladni::show {
namespace {

const char* matched_by(identification::MatchedBy by) {
  switch (by) {
    case identification::MatchedBy::pairs:
      return "pairs";
    case identification::MatchedBy::geometry:
      return "geometry";
    case identification::MatchedBy::prior:
      return "simulation";
    case identification::MatchedBy::nothing:
      return "nothing";
  }
  return "";
}

std::vector<std::string> row_names(const steps::IdentifiedModel& model) {
  std::vector<std::string> names;
  for (const auto& row : model.match.rows) {
    const auto& side = row.actuator ? model.seen.inputs : model.seen.outputs;
    names.push_back(side[static_cast<std::size_t>(row.channel)].name);
  }
  return names;
}

io::Json gain_json(const steps::IdentifiedModel& model) {
  const auto& modes = model.match.modes;
  const auto n = static_cast<Eigen::Index>(modes.size());
  Eigen::VectorXd alpha(n);
  Eigen::VectorXd deviation(n);
  std::vector<std::string> by;
  for (Eigen::Index m = 0; m < n; ++m) {
    const auto& mode = modes[static_cast<std::size_t>(m)];
    alpha(m) = mode.alpha * mode.sign;
    deviation(m) = mode.by == identification::MatchedBy::nothing ? NAN : mode.alpha_std;
    by.emplace_back(matched_by(mode.by));
  }
  io::JsonArray pairs;
  for (std::size_t c = 0; c < model.pairs.size(); ++c) {
    const auto& gain = model.match.pairs[c];
    pairs.push_back(io::JsonObject{
        {"sensor", model.seen.outputs[static_cast<std::size_t>(model.pairs[c].output)].name},
        {"actuator", model.seen.inputs[static_cast<std::size_t>(model.pairs[c].input)].name},
        {"gain_ratio", gain.ratio},
        {"gain_ratio_std", gain.ratio_std},
        {"part", gain.part + 1},
        {"part_std", gain.modes > 0 ? gain.part_std : NAN},
        {"turned", gain.turned}});
  }
  return io::JsonObject{{"alpha", io::Json(alpha)},
                        {"alpha_std", io::Json(deviation)},
                        {"by", io::Json::texts(by)},
                        {"pairs", pairs}};
}

io::Json fit_json(const steps::IdentifiedModel& model) {
  io::JsonArray channels;
  for (Eigen::Index j = 0; j < model.error.cols(); ++j) {
    for (Eigen::Index i = 0; i < model.error.rows(); ++i) {
      io::JsonObject response{{"sensor", model.seen.outputs[static_cast<std::size_t>(i)].name},
                              {"actuator", model.seen.inputs[static_cast<std::size_t>(j)].name},
                              {"relative_error", model.error(i, j)},
                              {"noise_floor", model.noise(i, j)}};
      if (model.drift.size() > 0)
        response.emplace_back("drift", model.drift(i + model.error.rows() * j));
      channels.emplace_back(std::move(response));
    }
  }
  const auto& fit = model.found.fit;
  return io::JsonObject{{"relative_error", steps::overall_error(model)},
                        {"noise_floor", steps::noise(model)},
                        {"per_channel", channels},
                        {"cost", fit.cost},
                        {"expected_cost", fit.expected_cost},
                        {"expected_cost_std", fit.cost_deviation},
                        {"noise_known", model.data.noise_known},
                        {"parameters", static_cast<long long>(fit.parameter_count)},
                        {"measured_numbers", static_cast<long long>(fit.measured_count)},
                        {"iterations", fit.iterations},
                        {"converged", fit.converged}};
}

io::Json steps_json(const identification::Identified& found) {
  io::JsonArray steps;
  for (const auto& step : found.steps) {
    steps.push_back(io::JsonObject{{"modes", static_cast<long long>(step.modes)},
                                   {"cost", step.cost},
                                   {"excess", step.excess},
                                   {"taken", step.taken}});
  }
  return steps;
}

io::Json stabilisation_json(const std::vector<identification::StabilisationPoint>& points) {
  io::JsonArray array;
  for (const auto& point : points) {
    array.push_back(io::JsonObject{{"order", static_cast<long long>(point.order)},
                                   {"frequency_hz", point.frequency_hz},
                                   {"damping_ratio", point.damping_ratio},
                                   {"stable_frequency", point.stable_frequency},
                                   {"stable_damping", point.stable_damping},
                                   {"stable_shape", point.stable_shape}});
  }
  return array;
}

// From 1, as MATLAB counts.
Eigen::MatrixXd numbers_of(const std::vector<Eigen::Index>& modes) {
  Eigen::MatrixXd numbers(std::ssize(modes), 1);
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    numbers(i) = static_cast<double>(modes[static_cast<std::size_t>(i)] + 1);
  }
  return numbers;
}

// The state space of real modes has all places of the extended model as outputs; that of complex
// modes has the sensors.
io::MatFields matlab_variables(const study::Study& study, const steps::IdentifiedModel& model,
                               const modal::ReducedModel& extended) {
  const auto& fit = model.found.fit;
  const auto space = fit.complex ? identification::state_space(fit.model, *fit.complex)
                                 : modal::state_space(extended);
  io::MatFields fields{
      {"A", space.a},
      {"B", space.b},
      {"C", space.c},
      {"D", space.d},
      {"delay_s", fit.delay_s},
      {"outputs", fit.complex ? modal::names_of(model.seen.outputs) : row_names(model)},
      {"inputs", modal::names_of(model.seen.inputs)},
      {"frequency_hz", Eigen::MatrixXd(extended.frequency_hz)},
      {"damping_ratio", Eigen::MatrixXd(extended.damping_ratio)},
      {"modes_within", numbers_of(steps::modes_within(model))},
      {"title", study.title}};
  if (fit.channel_delay_s.size() > 0) {  // of the channels of one side, beside delay_s
    const bool of_sensors = fit.delay_of == identification::DelayOf::outputs;
    fields.emplace_back("delay_of", of_sensors ? "sensors" : "actuators");
    fields.emplace_back("channel_delay_s", Eigen::MatrixXd(fit.channel_delay_s));
  }
  if (fit.complex) {
    fields.emplace_back("L", fit.complex->outputs);
    fields.emplace_back("R", fit.complex->inputs);
  }
  return fields;
}

// Those of more than one mode.
io::JsonArray groups_json(const identification::ModalFit& fit) {
  io::JsonArray groups;
  for (const auto& group : fit.groups) {
    if (group.size > 1) {
      groups.push_back(io::JsonObject{{"first", static_cast<long long>(group.first)},
                                      {"size", static_cast<long long>(group.size)}});
    }
  }
  return groups;
}

// What only a fit of complex shapes has, one of recordings, one with channels that have places.
void add_what_some_have(const study::Study& study, const steps::IdentifiedModel& model,
                        io::JsonObject& json) {
  if (const auto& complex = model.found.fit.complex) {
    json.emplace_back("complex_shapes", complex_json(*complex));
    json.emplace_back("imaginary_shapes",
                      io::JsonObject{{"channels", io::Json::texts(row_names(model))},
                                     {"value", io::Json::rows(model.match.imaginary)},
                                     {"std", io::Json::rows(model.match.imaginary_deviation)}});
  }
  if (model.measured.quality) json.emplace_back("data_quality", quality_json(model));
  if (const auto body = steps::rigid_body_of_channels(study, model)) {
    json.emplace_back("rigid_body", rigid_body_json(*body));
  }
}

std::string gain_text(const identification::ModeMatch& match) {
  if (match.by == identification::MatchedBy::nothing) return "unknown";
  return fmt::format("{}{:.4g} +- {}", match.sign < 0 ? "-" : "", match.alpha,
                     deviation_text(match.alpha_std));
}

// Model error over the band: at the median line, and the largest.
std::string model_error_text(const steps::IdentifiedModel& model) {
  if (model.model_error.size() == 0) return " and the stated error of the model";
  Eigen::VectorXd sorted = model.model_error;
  std::sort(sorted.begin(), sorted.end());
  return fmt::format(" and the stated error of the model; as fitted it is off by {}, at most {}",
                     percent(sorted(sorted.size() / 2)), percent(sorted(sorted.size() - 1)));
}

}  // namespace

io::ResultTable identified_modes_table(const steps::IdentifiedModel& model) {
  const auto& fit = model.found.fit;
  const auto& modes = fit.model;
  std::vector<std::string> number, frequency, damping, gain;
  std::vector<io::Json> rigid;
  for (Eigen::Index m = 0; m < modes.mode_count(); ++m) {
    const bool is_rigid = m < modes.rigid_count;
    number.push_back(fmt::to_string(m + 1));
    frequency.push_back(is_rigid ? "0, rigid body"
                                 : fmt::format("{:.4f} +- {}", modes.frequency_hz(m),
                                               deviation_text(fit.frequency_std_hz(m))));
    damping.push_back(is_rigid ? ""
                               : fmt::format("{:.6f} +- {}", modes.damping_ratio(m),
                                             deviation_text(fit.damping_std(m))));
    gain.push_back(gain_text(model.match.modes[static_cast<std::size_t>(m)]));
    rigid.emplace_back(is_rigid);
  }
  io::ResultTable table{"Modes, with standard deviations",
                        {io::word_column("mode", number, 4), io::word_column("Hz", frequency, 24),
                         io::word_column("damping ratio", damping, 26),
                         io::word_column("gain of L over R", gain, 22)}};
  for (auto& column : table.columns) {
    column.is_number = true;
    column.gap = 1;
  }
  table.columns.front().gap = 0;
  table.columns.push_back(io::json_column("frequency_hz", modes.frequency_hz));
  table.columns.push_back(io::json_column("damping_ratio", modes.damping_ratio));
  table.columns.push_back(io::json_column("frequency_std_hz", fit.frequency_std_hz));
  table.columns.push_back(io::json_column("damping_std", fit.damping_std));
  table.columns.push_back(io::json_column("rigid", rigid));
  return table;
}

std::string noise_text(const steps::IdentifiedModel& model) {
  if (!model.data.weights_are_deviations) return "their noise is not known";
  return fmt::format(
      "{} {}", model.data.noise_known ? "noise" : "noise with the error that the model may have",
      percent(steps::noise(model)));
}

// The delay of all responses, or that of each channel of the side that has its own.
std::string fitted_delay_text(const steps::IdentifiedModel& model) {
  const auto& fit = model.found.fit;
  const auto one = [](double delay, double deviation) {
    const bool known = std::isfinite(deviation);
    return known ? fmt::format("{:.2f} +- {} us", 1e6 * delay, deviation_text(1e6 * deviation))
                 : std::string("not known");
  };
  if (fit.channel_delay_s.size() == 0) {
    return fit.delay_std_s > 0.0 ? "; delay " + one(fit.delay_s, fit.delay_std_s) : "";
  }
  const auto& channels =
      fit.delay_of == identification::DelayOf::outputs ? model.seen.outputs : model.seen.inputs;
  std::string text = "; delay";
  for (Eigen::Index c = 0; c < fit.channel_delay_s.size(); ++c) {
    text += fmt::format("{} {} {}", c > 0 ? "," : "", channels[static_cast<std::size_t>(c)].name,
                        one(fit.delay_s + fit.channel_delay_s(c), fit.channel_delay_std_s(c)));
  }
  return text;
}

std::string identification_table(const steps::IdentifiedModel& model) {
  const auto& fit = model.found.fit;
  const auto& data = model.data;
  std::string text = quality_text(model);
  text += fmt::format("{}, {}, {}, {:.6g} to {:.6g} Hz\n\n{}", how_many(data.outputs, "sensor"),
                      how_many(data.inputs, "actuator"), how_many(data.line_count(), "line"),
                      data.frequency_hz(0), data.frequency_hz(data.line_count() - 1),
                      io::text(identified_modes_table(model)));
  if (fit.complex) text += complex_table(fit);
  text += fmt::format("\nresponses off by {} of their size, {}",
                      percent(steps::overall_error(model)), noise_text(model));
  text += fitted_delay_text(model);
  const std::string noise_is = data.noise_known               ? ""
                               : !data.weights_are_deviations ? " (as if the weights were those of "
                                                                "noise)"
                               : data.noise_stated            ? model_error_text(model)
                                                   : " (noise estimated from the lines' scatter, "
                                                     "and the error that the model may have)";
  text += fmt::format("\ncost {:.5g}, of noise alone {:.5g} +- {}{}\n", fit.cost, fit.expected_cost,
                      deviation_text(fit.cost_deviation), noise_is);
  return text + validation_text(model) + trust_text(model);
}

std::string identification_text(const study::Study& study, const steps::IdentifiedModel& model) {
  const auto body = steps::rigid_body_of_channels(study, model);
  return identification_table(model) + (body ? rigid_body_text(*body) : "");
}

io::JsonObject identified_json(const study::Study& study, const steps::IdentifiedModel& model) {
  const auto& fit = model.found.fit;
  io::JsonObject json{{"damping", fit.complex ? "general" : "modal"},
                      {"sensors", io::Json::texts(modal::names_of(model.seen.outputs))},
                      {"actuators", io::Json::texts(modal::names_of(model.seen.inputs))},
                      {"modes", io::json_rows(identified_modes_table(model))},
                      {"output_matrix", io::Json::rows(fit.model.output_shapes)},
                      {"input_matrix", io::Json::rows(fit.model.input_shapes)},
                      {"output_std", io::Json::rows(fit.output_std)},
                      {"input_std", io::Json::rows(fit.input_std)},
                      {"residual", io::Json::rows(fit.model.residual)},
                      {"delay_s", fit.delay_s},
                      {"delay_std_s", fit.delay_std_s},
                      {"channel_delay_s", io::Json(fit.channel_delay_s)},
                      {"channel_delay_std_s", io::Json(fit.channel_delay_std_s)},
                      {"model_error", io::Json(model.model_error)},
                      {"groups", groups_json(fit)},
                      {"gain_match", gain_json(model)},
                      {"shapes", io::JsonObject{{"channels", io::Json::texts(row_names(model))},
                                                {"value", io::Json::rows(model.match.shapes)},
                                                {"std", io::Json::rows(model.match.deviation)}}},
                      {"fit", fit_json(model)},
                      {"trust", trust_json(model)},
                      {"validation", validation_json(model)},
                      {"noise_floor", io::Json::rows(model.noise)},
                      {"order", steps_json(model.found)},
                      {"stabilisation", stabilisation_json(model.stabilisation)},
                      {"notes", io::Json::texts(fit.notes)},
                      {"warnings", io::Json::texts(model.match.warnings)}};
  add_what_some_have(study, model, json);
  return json;
}

io::ShapeTable identified_shapes(const steps::IdentifiedModel& model) {
  const auto within = steps::modes_within(model);
  const auto& modes = model.found.fit.model;
  const Eigen::MatrixXd deviation = model.match.deviation(Eigen::all, within);
  const Eigen::MatrixXd shapes = model.match.shapes(Eigen::all, within);
  return {row_names(model), modes.frequency_hz(within), modes.damping_ratio(within),
          deviation.array().isFinite().select(shapes, std::nan("")), deviation};
}

void leave_identification(const study::Study& study, const steps::IdentifiedModel& model, Run& run,
                          bool main_result) {
  const auto& fit = model.found.fit;
  const auto extended = identification::driven_model(fit, model.match);
  auto variables = matlab_variables(study, model, extended);
  if (const auto body = steps::rigid_body_of_channels(study, model)) {
    variables.emplace_back("rigid_body", rigid_body_mat(*body));
    for (const auto& note : body->notes) run.warn(note);
  }
  leave_detection_lines(model, run);
  io::write_mat(run / "identified.mat", variables);
  io::write_shapes(run / "identified_shapes.csv", identified_shapes(model));
  leave_modes_uff(study, model, run);
  if (run.options().pictures) tell(run.progress(), "drawing");
  run.paint("fit.png", [&](const auto& png) { draw_fit(model, png); });
  leave_curves(run, "fit_curves.json", [&] { return fitted_curves(model, kStoredCurvesBytes); });
  run.paint("stabilisation.png", [&](const auto& png) {
    if (!model.stabilisation.empty()) draw_stabilisation(model, png);
  });
  run.leave("identified.json", identified_json(study, model), main_result);
  leave_control_models(study, model, run);
}

std::function<void(const steps::IdentifiedModel&)> shown_and_left(const study::Study& study,
                                                                  Run& run) {
  return [&study, &run](const steps::IdentifiedModel& model) {
    run.show(identification_text(study, model) + "\n");
    leave_identification(study, model, run, false);
  };
}

}  // namespace chladni::show
