// predicted.csv, predicted_band.csv and spatio_temporal.*: responses at places without a
// measurement.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/atomic_file.h"
#include "io/frf_file.h"
#include "io/mat.h"
#include "modal/state_space.h"
#include "show/interpolation.h"
#include "steps/interpolation.h"
#include "steps/predicted.h"

namespace chladni::show {
namespace {

modal::FrfSet as_set(const steps::IdentifiedModel& model, const std::vector<std::string>& names,
                     const Eigen::VectorXd& frequency_hz) {
  modal::FrfSet set;
  for (const auto& name : names) {
    modal::MeasuredChannel channel;
    channel.name = name;
    set.outputs.push_back(channel);
  }
  set.inputs = model.seen.inputs;
  set.frequency_hz = frequency_hz;
  return set;
}

// Variances in the form of a set of responses: NaN if not known.
Eigen::MatrixXd known_variance(const Eigen::MatrixXd& deviation) {
  return deviation.unaryExpr([](double one) { return std::isfinite(one) ? one * one : NAN; });
}

// The unmeasured sensors, then the points.
identification::PlacesOfInterest all_of_interest(const steps::Interpolated& result) {
  const auto& shown = result.methods.front();
  auto all = steps::places_of_interest(result, result.unmeasured_places, shown.unmeasured);
  if (result.points.empty()) return all;
  const auto points = steps::places_of_interest(result, result.point_places, shown.points);
  const auto append = [](Eigen::MatrixXd& rows, const Eigen::MatrixXd& below) {
    const auto n = rows.rows();
    rows.conservativeResize(n + below.rows(), below.cols());
    rows.bottomRows(below.rows()) = below;
  };
  append(all.shapes, points.shapes);
  append(all.deviation, points.deviation);
  append(all.residual, points.residual);
  append(all.imaginary, points.imaginary);
  append(all.imaginary_deviation, points.imaginary_deviation);
  append(all.residual_deviation, points.residual_deviation);
  return all;
}

// Sets the deviation of modes without a scale, and of rigid-body modes without a body, to NaN:
// their shapes are 0 because they are left out, not because they are known.
Eigen::MatrixXd stated_deviation(const steps::Measured& measured,
                                 const Eigen::MatrixXd& deviation) {
  Eigen::MatrixXd stated = deviation;
  const auto rigid = measured.identified->found.fit.model.rigid_count;
  if (!measured.identified->match.rigid) stated.leftCols(rigid).setConstant(NAN);
  for (auto m = rigid; m < stated.cols(); ++m) {
    const auto& used = measured.fitted_mode;
    if (std::find(used.begin(), used.end(), m) == used.end()) stated.col(m).setConstant(NAN);
  }
  return stated;
}

// Warns of places without a band.
void warn_of_unknown(const modal::FrfSet& band, const std::string& file, Run& run) {
  std::string names;
  for (Eigen::Index i = 0; i < band.output_count(); ++i) {
    const bool unknown = std::any_of(band.variance.begin(), band.variance.end(),
                                     [i](const auto& line) { return line.row(i).hasNaN(); });
    if (unknown)
      names += (names.empty() ? "" : ", ") + band.outputs[static_cast<std::size_t>(i)].name;
  }
  if (names.empty()) return;
  run.warn(fmt::format(
      "{}: the deviation of what is predicted at {} is not known (empty cells): a deviation of the "
      "fit or of the interpolated shapes is not",
      file, names));
}

void add_imaginary(const identification::PlacesOfInterest& interest, io::MatFields& variables,
                   io::JsonObject& json) {
  variables.emplace_back("shapes_imaginary", interest.imaginary);
  variables.emplace_back("shapes_imaginary_std", interest.imaginary_deviation);
  json.emplace_back("shapes_imaginary", io::Json::rows(interest.imaginary));
  json.emplace_back("shapes_imaginary_std", io::Json::rows(interest.imaginary_deviation));
}

void leave_state_space(const steps::Interpolated& result, const std::vector<std::string>& outputs,
                       const identification::PlacesOfInterest& interest,
                       const std::vector<std::string>& notes, Run& run) {
  const auto& model = steps::identified_of(result);
  const auto& fit = model.found.fit;
  const auto deviation = stated_deviation(result.measured, interest.deviation);
  const auto at = identification::model_at(fit, model.match, interest);
  const auto space = fit.complex ? identification::state_space(
                                       at, identification::complex_shapes_at(model.match, interest))
                                 : modal::state_space(at);
  const auto inputs = modal::names_of(model.seen.inputs);
  const Eigen::VectorXd late = identification::input_delays(fit);
  io::MatFields variables{{"A", space.a},
                          {"B", space.b},
                          {"C", space.c},
                          {"D", space.d},
                          {"delay_s", fit.delay_s},
                          {"outputs", outputs},
                          {"inputs", inputs},
                          {"shapes", interest.shapes},
                          {"shapes_std", deviation},
                          {"input_delay_s", Eigen::MatrixXd(late)}};
  io::JsonObject json{{"outputs", io::Json::texts(outputs)},
                      {"inputs", io::Json::texts(inputs)},
                      {"a", io::Json::rows(space.a)},
                      {"b", io::Json::rows(space.b)},
                      {"c", io::Json::rows(space.c)},
                      {"d", io::Json::rows(space.d)},
                      {"delay_s", fit.delay_s},
                      {"input_delay_s", io::Json(late)},
                      {"shapes", io::Json::rows(interest.shapes)},
                      {"shapes_std", io::Json::rows(deviation)},
                      {"left_out", io::Json::texts(notes)}};
  if (fit.complex) add_imaginary(interest, variables, json);
  io::write_mat(run / "spatio_temporal.mat", variables);
  run.leave("spatio_temporal.json", json, false);
}

}  // namespace

void leave_predictions(const steps::Interpolated& result, const std::string& file, Run& run) {
  const auto& model = steps::identified_of(result);
  std::vector<std::string> names = result.unmeasured;
  names.insert(names.end(), result.points.begin(), result.points.end());
  if (names.empty()) return;
  const auto interest = all_of_interest(result);
  auto lines = model.measured.all.frequency_hz;
  if (model.found.fit.model.rigid_count > 0 && lines(0) == 0.0) {
    lines = Eigen::VectorXd(lines.tail(lines.size() - 1));
  }
  const auto stem = std::filesystem::path(file).stem().string();
  const auto responses = identification::predicted(model.found.fit, model.match, interest, lines);
  auto receptance = as_set(model, names, lines);
  receptance.value = responses.value;
  for (const auto& deviation : responses.deviation) {
    receptance.variance.push_back(known_variance(deviation));
  }
  const auto notes = steps::left_out_of_predictions(result);
  for (const auto& note : notes) run.warn(note);
  warn_of_unknown(receptance, stem + "_band.csv", run);
  write_atomically(run / (stem + "_band.csv"), io::frf_csv(receptance));
  run.paint(predictions_picture(file),
            [&](const auto& png) { draw_predictions(model, receptance, png); });
  receptance.variance.clear();
  write_atomically(run / file, io::frf_csv(receptance));
  leave_state_space(result, names, interest, notes, run);
}

}  // namespace chladni::show
