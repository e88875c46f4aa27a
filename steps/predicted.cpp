// From identified responses to shapes at the channels, and from a field of shapes to responses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "identification/damping_coupling.h"
#include "steps/interpolation.h"
#include "steps/predicted.h"

namespace chladni::steps {
namespace {

constexpr double kExplained = 0.3;  // part of the fitted residual that the simulation must explain
constexpr double kBeyond = 1.05;    // simulated modes above this multiple of the band are residual

// The site of a channel of the study, by name.
const ChannelSite& site_of(const std::vector<ChannelSite>& all, const std::string& name) {
  return all[static_cast<std::size_t>(index_of(all, name))];
}

// Remaining difference between the two sides of the pairs, for each mode. The deviations of the fit
// do not contain these errors (gains, places, neighbours). If the places of a pair differ, it is
// the part that remains along the simulated shape at both places, because near a node the ratio of
// the sides has no meaning.
Eigen::VectorXd disagreement(const IdentifiedModel& model) {
  const auto& fit = model.found.fit.model;
  const auto& match = model.match;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(fit.mode_count());
  if (model.pairs.size() < 2) return result;
  for (auto m = fit.rigid_count; m < fit.mode_count(); ++m) {
    const auto& mode = match.modes[static_cast<std::size_t>(m)];
    if (mode.by != identification::MatchedBy::pairs) continue;
    double square = 0.0;
    for (std::size_t c = 0; c < model.pairs.size(); ++c) {
      const auto& pair = model.pairs[c];
      const bool apart = !pair.is_one_place();
      const double here = apart ? pair.at_input(m) : 1.0;
      const double there = apart ? pair.at_output(m) : 1.0;
      // The part that the gains explain is corrected, on either side.
      const double gain = model.corrects_gains ? match.pairs[c].ratio : 1.0;
      const double output = fit.output_shapes(pair.output, m) / mode.alpha / gain;
      const double input = mode.sign * mode.alpha * fit.input_shapes(m, pair.input);
      const double size = std::hypot(here, there);
      if (size > 0.0) square += std::pow((output * here - input * there) / size, 2);
    }
    result(m) = std::sqrt(square / static_cast<double>(model.pairs.size()));
  }
  return result;
}

// Modes that have a scale and are not rigid-body modes.
std::vector<Eigen::Index> usable_modes(const IdentifiedModel& model, stage::Work& work) {
  std::vector<Eigen::Index> modes;
  const auto& fit = model.found.fit.model;
  for (auto m = fit.rigid_count; m < fit.mode_count(); ++m) {
    if (model.match.deviation.col(m).allFinite()) {
      modes.push_back(m);
    } else {
      work.warn(
          fmt::format("mode {} ({:.1f} Hz) has no known scale between sensors and "
                      "actuators: it takes no part in what is predicted elsewhere",
                      m + 1, fit.frequency_hz(m)));
    }
  }
  require(!modes.empty(),
          "no identified mode has a known scale: name a pair of a sensor and an "
          "actuator at one place ([identification] pair)");
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

// Static flexibility of the simulation's modes above the band, places × actuators.
Eigen::MatrixXd flexibility_above(const Interpolated& result, const Eigen::MatrixXd& places,
                                  const Eigen::MatrixXd& inputs) {
  const auto& model = identified_of(result);
  const auto& frequency = result.simulation.frequency_hz;
  const double above = kBeyond * model.data.frequency_hz(model.data.line_count() - 1);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(places.rows(), inputs.rows());
  for (Eigen::Index r = 0; r < frequency.size(); ++r) {
    if (frequency(r) < above) continue;
    const double omega = 2.0 * std::numbers::pi * frequency(r);
    sum += places.col(r) * inputs.col(r).transpose() / (omega * omega);
  }
  return sum;
}

// Fitted residual over simulated residual; zero if the simulated one does not explain it.
double residual_factor(const Interpolated& result) {
  const auto& measured = result.measured;
  const auto& model = identified_of(result);
  const auto& fitted = model.found.fit.model.residual;
  const auto at_sensors = flexibility_above(result, measured.sensor_shapes, measured.input_shapes);
  const double square = at_sensors.squaredNorm();
  const double factor = square > 0.0 ? at_sensors.cwiseProduct(fitted).sum() / square : 0.0;
  const double left = (fitted - factor * at_sensors).squaredNorm();
  const bool explains = factor > 0.0 && left < (1.0 - kExplained) * fitted.squaredNorm();
  return explains ? factor : 0.0;
}

// The simulated residual in the scale of the fitted one.
Eigen::MatrixXd residual_at(const Interpolated& result, const priors::Places& places) {
  return residual_factor(result) *
         flexibility_above(result, places.shapes, result.measured.input_shapes);
}

// Rigid-body rows at places that move along z.
void add_rigid_rows(const IdentifiedModel& model, const priors::Places& places,
                    identification::PlacesOfInterest& result) {
  const auto rigid = model.found.fit.model.rigid_count;
  if (rigid == 0 || !model.match.rigid) return;
  const auto directions =
      identification::rigid_directions(Eigen::MatrixX3d(places.position), rigid_motion(rigid));
  result.shapes.leftCols(rigid) =
      places.direction.col(2).asDiagonal() * (directions * model.match.rigid->modes);
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
    result.channels.push_back(used.back().name);
  }
  const auto& fit = model->found.fit.model;
  const auto& modes = result.fitted_mode;
  const Eigen::VectorXd doubt = disagreement(*model)(modes);
  const Eigen::MatrixXd deviation = model->match.deviation(Eigen::all, modes);
  result.shapes = {places_at(used, solution.modes, harmonics), fit.frequency_hz(modes),
                   model->match.shapes(Eigen::all, modes),
                   (deviation.cwiseAbs2().rowwise() + doubt.cwiseAbs2().transpose()).cwiseSqrt()};
  result.damping_ratio = fit.damping_ratio(modes);
  std::vector<ChannelSite> sensors;
  std::vector<ChannelSite> actuators;
  for (const auto& one : model->seen.outputs) sensors.push_back(site_of(sites, one.name));
  for (const auto& one : model->seen.inputs) actuators.push_back(site_of(sites, one.name));
  result.sensor_shapes = places_at(sensors, solution.modes).shapes;
  result.input_shapes = places_at(actuators, solution.modes).shapes;
  add_hidden(study, solution, sites, harmonics, *model, result);
  return result;
}

// The ratio of sensor rows to actuator rows is proportional to the square of the scale.
std::optional<priors::MeasuredShapes> with_scale_off(const Measured& measured) {
  constexpr double kLeast = 1e-3;
  if (!measured.identified) return std::nullopt;
  const auto& match = measured.identified->match;
  Eigen::RowVectorXd factor = Eigen::RowVectorXd::Ones(std::ssize(measured.fitted_mode));
  for (std::size_t k = 0; k < measured.fitted_mode.size(); ++k) {
    const auto& one = match.modes[static_cast<std::size_t>(measured.fitted_mode[k])];
    const double relative = 2.0 * one.alpha_std / one.alpha;
    if (std::isfinite(relative)) factor(static_cast<Eigen::Index>(k)) += relative;
  }
  if (factor.maxCoeff() < 1.0 + kLeast) return std::nullopt;
  auto off = measured.shapes;
  for (std::size_t row = 0; row < match.rows.size(); ++row) {
    if (match.rows[row].actuator) {
      off.values.row(static_cast<Eigen::Index>(row)).array() *= factor.array();
    }
  }
  return off;
}

identification::PlacesOfInterest places_of_interest(const Interpolated& result,
                                                    const priors::Places& places,
                                                    const priors::Field& field) {
  const auto& model = identified_of(result);
  const auto m = model.found.fit.model.mode_count();
  identification::PlacesOfInterest interest{Eigen::MatrixXd::Zero(places.count(), m),
                                            Eigen::MatrixXd::Zero(places.count(), m),
                                            residual_at(result, places)};
  interest.shapes(Eigen::all, result.measured.fitted_mode) = field.mean;
  interest.deviation(Eigen::all, result.measured.fitted_mode) = field.deviation;
  add_rigid_rows(model, places, interest);
  if (model.found.fit.complex) {
    const auto parts = identification::imaginary_parts(
        model.found.fit, model.match,
        {result.simulation.frequency_hz, result.measured.shapes.places.shapes, places.shapes});
    interest.imaginary = parts.mean;
    interest.imaginary_deviation = parts.deviation;
  }
  return interest;
}

Eigen::VectorXd held_out_frf_errors(const Interpolated& result, const Interpolation& one) {
  const auto& model = identified_of(result);
  const auto& measured = result.measured;
  Eigen::VectorXd errors(measured.hidden.places.count());
  const auto interest = places_of_interest(result, measured.hidden.places, one.hidden);
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
      const Eigen::RowVectorXcd there = real.value[k].row(0);
      if (!there.allFinite()) continue;
      wrong += (responses.value[k].row(c) - there).squaredNorm();
      size += there.squaredNorm();
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

std::vector<std::string> left_out_of_predictions(const Interpolated& result) {
  const auto& model = identified_of(result);
  const auto& fit = model.found.fit.model;
  std::vector<std::string> notes;
  const auto& used = result.measured.fitted_mode;
  for (auto m = fit.rigid_count; m < fit.mode_count(); ++m) {
    if (std::find(used.begin(), used.end(), m) != used.end()) continue;
    notes.push_back(
        fmt::format("mode {} ({:.1f} Hz) is neither in the predicted responses nor in their band: "
                    "its scale between sensors and actuators is not known",
                    m + 1, fit.frequency_hz(m)));
  }
  if (fit.rigid_count > 0 && !model.match.rigid) {
    notes.push_back(fmt::format(
        "the term in 1/s^2 of {} modes at 0 Hz is neither in the predicted responses nor in their "
        "band: the motion of the body as a whole is known of 2 or 3 such modes whose channels all "
        "act along z and tell them apart",
        fit.rigid_count));
  }
  if (model.found.fit.residual_std.size() > 0 && fit.residual.squaredNorm() > 0.0 &&
      residual_factor(result) == 0.0) {
    notes.emplace_back(
        "the modes above the band are neither in the predicted responses nor in their band: the "
        "simulation does not explain the fitted residual");
  }
  return notes;
}

}  // namespace chladni::steps
