// From identified responses of a study to shapes at its channels, and from a field to responses.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "identification/response_field.h"
#include "steps/interpolation.h"
#include "steps/predicted.h"

namespace chladni::steps {
namespace {

// The site of a channel of the study, by name.
const ChannelSite& site_of(const std::vector<ChannelSite>& sites, const std::string& name) {
  return sites[static_cast<std::size_t>(index_of(sites, name))];
}

// The measured channels at which a mode with a scale is not known.
std::vector<std::string> names_without(const IdentifiedModel& model, Eigen::Index mode) {
  std::vector<std::string> names;
  for (const auto row : identification::rows_without(model.found.fit, model.match, mode)) {
    const auto& matched = model.match.rows[static_cast<std::size_t>(row)];
    const auto& side = matched.actuator ? model.seen.inputs : model.seen.outputs;
    names.push_back(side[static_cast<std::size_t>(matched.channel)].name);
  }
  return names;
}

// Modes that have a scale and are not rigid-body modes.
std::vector<Eigen::Index> usable_modes(const IdentifiedModel& model, stage::Work& work) {
  const auto& fit = model.found.fit;
  const auto modes = identification::modes_with_scale(fit, model.match);
  for (const auto m : modes_within(model)) {
    if (m < fit.model.rigid_count || std::ranges::find(modes, m) != modes.end()) continue;
    const auto unknown_at = names_without(model, m);
    const auto why = unknown_at.empty()
                         ? std::string("has no known scale between sensors and actuators")
                         : fmt::format("is not known at {}", fmt::join(unknown_at, ", "));
    work.warn(fmt::format("mode {} ({:.1f} Hz) {}; it takes no part in what is predicted elsewhere",
                          m + 1, fit.model.frequency_hz(m), why));
  }
  require(!modes.empty(), identification::why_none_has_scale(fit, model.match));
  return modes;
}

void add_hidden(const study::Study& study, const stage::Solution& solution,
                const std::vector<ChannelSite>& sites, const fem::LaplaceSpectrum& harmonics,
                const IdentifiedModel& model, Measured& result) {
  const auto& hold_out = study.measurement->hold_out;
  std::vector<ChannelSite> hidden;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < model.measured.all.outputs.size(); ++i) {
    const auto& name = model.measured.all.outputs[i].name;
    if (std::find(hold_out.begin(), hold_out.end(), name) == hold_out.end()) continue;
    hidden.push_back(site_of(sites, name));
    rows.push_back(static_cast<Eigen::Index>(i));
    result.hidden_channels.push_back(name);
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  const auto m = static_cast<Eigen::Index>(result.fitted_mode.size());
  result.hidden = {places_at(hidden, solution.modes, harmonics), result.shapes.frequency_hz,
                   Eigen::MatrixXd(n, m), Eigen::MatrixXd(n, m)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = identification::fitted_row(
        model.found.fit, model.match,
        fit_data_of(study, model,
                    modal::part(model.measured.all, {rows[static_cast<std::size_t>(i)]},
                                model.measured.inputs)));
    result.hidden.values.row(i) = row.shape(result.fitted_mode);
    result.hidden.noise.row(i) = row.deviation(result.fitted_mode);
  }
}

// The simulation at the channels of the identified model.
identification::FieldSimulation field_simulation(const Interpolated& result) {
  const auto& model = identified_of(result);
  const auto& measured = result.measured;
  const auto& rows = model.match.rows;
  Eigen::MatrixXd at_rows(std::ssize(rows), measured.sensor_shapes.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& side = rows[i].actuator ? measured.input_shapes : measured.sensor_shapes;
    at_rows.row(static_cast<Eigen::Index>(i)) = side.row(rows[i].channel);
  }
  return {{result.simulation.frequency_hz, measured.sensor_shapes, measured.input_shapes},
          std::move(at_rows),
          model.data.frequency_hz(model.data.line_count() - 1)};
}

}  // namespace

Measured measured_by_responses(const study::Study& study, const stage::Solution& solution,
                               const fem::LaplaceSpectrum& harmonics, stage::Work& work,
                               const OnIdentified& on_identified) {
  Measured result;
  auto model = std::make_shared<IdentifiedModel>(identified(study, &solution, work));
  if (on_identified) on_identified(*model);
  result.identified = model;
  result.fitted_mode = usable_modes(*model, work);
  const auto sites = channel_sites(study, solution.model);
  std::vector<ChannelSite> used;
  for (const auto& row : model->match.rows) {
    const auto& side = row.actuator ? model->seen.inputs : model->seen.outputs;
    used.push_back(site_of(sites, side[static_cast<std::size_t>(row.channel)].name));
  }
  const auto& fit = model->found.fit;
  for (const auto row : identification::measured_rows(fit, model->match)) {
    result.channels.push_back(used[static_cast<std::size_t>(row)].name);
  }
  result.shapes =
      identification::measured_shapes(fit, *model, places_at(used, solution.modes, harmonics));
  result.damping_ratio = fit.model.damping_ratio(result.fitted_mode);
  std::vector<ChannelSite> sensors;
  std::vector<ChannelSite> actuators;
  for (const auto& output : model->seen.outputs) sensors.push_back(site_of(sites, output.name));
  for (const auto& input : model->seen.inputs) actuators.push_back(site_of(sites, input.name));
  result.sensor_shapes = places_at(sensors, solution.modes).shapes;
  result.input_shapes = places_at(actuators, solution.modes).shapes;
  add_hidden(study, solution, sites, harmonics, *model, result);
  return result;
}

std::optional<priors::MeasuredShapes> with_scale_off(const Measured& measured) {
  if (!measured.identified) return std::nullopt;
  return identification::with_scale_off(measured.identified->match, measured.fitted_mode,
                                        measured.shapes);
}

identification::PlacesOfInterest places_of_interest(const Interpolated& result,
                                                    const priors::Places& places,
                                                    const priors::Field& field) {
  const auto& model = identified_of(result);
  return identification::places_of_interest(model.found.fit, model, result.measured.fitted_mode,
                                            field_simulation(result), places, field);
}

Eigen::VectorXd held_out_frf_errors(const Interpolated& result,
                                    const Interpolation& interpolation) {
  const auto& model = identified_of(result);
  const auto& measured = result.measured;
  Eigen::VectorXd errors(measured.hidden.places.count());
  const auto interest = places_of_interest(result, measured.hidden.places, interpolation.hidden);
  const auto& frequency = model.data.frequency_hz;
  const auto responses =
      identification::predicted(model.found.fit, model.match, interest, frequency);
  for (Eigen::Index c = 0; c < errors.size(); ++c) {
    const auto& name = measured.hidden_channels[static_cast<std::size_t>(c)];
    const auto row = index_of(model.measured.all.outputs, name);
    const auto real =
        modal::converted(modal::band(modal::part(model.measured.all, {row}, model.measured.inputs),
                                     frequency(0), frequency(frequency.size() - 1)),
                         modal::FrfKind::receptance);
    double wrong = 0.0;
    double size = 0.0;
    for (std::size_t k = 0; k < real.value.size(); ++k) {
      const Eigen::ArrayXcd measured_line = real.value[k].row(0).transpose();
      const Eigen::ArrayXcd predicted_line = responses.value[k].row(c).transpose();
      wrong += measured_line.isFinite().select((predicted_line - measured_line).abs2(), 0.0).sum();
      size += measured_line.isFinite().select(measured_line.abs2(), 0.0).sum();
    }
    errors(c) = std::sqrt(wrong / size);
  }
  return errors;
}

const IdentifiedModel& identified_of(const Interpolated& result) {
  require(result.measured.identified != nullptr,
          "responses are predicted from measured ones; expected measurement.frf");
  return *result.measured.identified;
}

std::string left_out_across_z(const Interpolated& result, const std::vector<std::string>& names,
                              const Points& directions) {
  const auto& model = identified_of(result);
  std::vector<std::string> across;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (!identification::moves_along_z(directions.row(row))) across.push_back(names[i]);
  }
  if (across.empty() || model.found.fit.model.rigid_count == 0 || !model.match.rigid) return "";
  return fmt::format(
      "the term in 1/s^2 of the modes at 0 Hz is not in the predicted responses at {}, their band "
      "has its size at the channels: the motion of the body as a whole is known along z alone",
      fmt::join(across, ", "));
}

std::vector<std::string> left_out_of_predictions(const Interpolated& result) {
  const auto& model = identified_of(result);
  const auto& fit = model.found.fit.model;
  std::vector<std::string> notes;
  const auto& used = result.measured.fitted_mode;
  for (auto m = fit.rigid_count; m < fit.mode_count(); ++m) {
    if (std::find(used.begin(), used.end(), m) != used.end()) continue;
    const auto unknown_at = names_without(model, m);
    const auto why = unknown_at.empty()
                         ? std::string("its scale between sensors and actuators is not known")
                         : fmt::format("its shape at {} is not known", fmt::join(unknown_at, ", "));
    notes.push_back(
        fmt::format("mode {} ({:.1f} Hz) is not in the predicted responses, {}; their "
                    "band has its size at the channels",
                    m + 1, fit.frequency_hz(m), why));
  }
  if (fit.rigid_count > 0 && !model.match.rigid) {
    notes.push_back(fmt::format(
        "the term in 1/s^2 of {} modes at 0 Hz is not in the predicted responses, their band has "
        "its size at the channels: the motion of the body as a whole is known of 2 or 3 such modes "
        "whose channels all act along z and tell them apart",
        fit.rigid_count));
  }
  const auto add_across = [&](const std::vector<std::string>& names, const priors::Places& places) {
    const auto note = left_out_across_z(result, names, places.direction);
    if (!note.empty()) notes.push_back(note);
  };
  add_across(result.measured.hidden_channels, result.measured.hidden.places);
  add_across(result.unmeasured, result.unmeasured_places);
  add_across(result.points, result.point_places);
  if (model.found.fit.residual_std.size() > 0 && fit.residual.squaredNorm() > 0.0 &&
      identification::residual_factor(model.match, field_simulation(result)) == 0.0) {
    notes.emplace_back(
        "the modes above the band are not in the predicted responses, the simulation does not "
        "explain the fitted residual; their band has its size at the sensors");
  }
  return notes;
}

const Interpolation& interpolation_called(const Interpolated& result, const std::string& name) {
  if (name.empty()) return result.methods.front();
  const auto found = std::ranges::find_if(
      result.methods, [&](const Interpolation& one) { return name == one.method->name; });
  require(found != result.methods.end(),
          "the study was not interpolated by \"" + name + "\"; interpolation.methods names how");
  return *found;
}

identification::PredictedResponses responses_at(const Interpolated& result,
                                                const Interpolation& interpolation,
                                                const priors::Places& places,
                                                const Eigen::VectorXd& frequency_hz) {
  const auto& model = identified_of(result);
  const auto interest = places_of_interest(result, places, field_at(interpolation, places));
  return identification::predicted(model.found.fit, model.match, interest, frequency_hz);
}

}  // namespace chladni::steps
