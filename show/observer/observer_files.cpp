// observe.json, observer.mat, observer.h and observer.png
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/turn.h"
#include "host/atomic_file.h"
#include "io/control_model.h"
#include "io/mat.h"
#include "io/plot.h"
#include "priors/interpolator.h"
#include "show/observer.h"
#include "steps/predicted.h"

namespace chladni::show {
namespace {

constexpr int kBlue = 1, kVermilion = 2, kGrey = 6;

io::Json points_json(const steps::Observer& observer) {
  io::JsonArray points;
  const auto names = observer.names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    points.push_back(io::JsonObject{{"name", names[i]},
                                    {"held_out_sensor", k >= std::ssize(names) - observer.judges},
                                    {"deviation_m", observer.deviation(k)},
                                    {"prediction_deviation_m", observer.prediction(k)},
                                    {"deviation_without_sensors_m", observer.without(k)},
                                    {"shape_deviation_m", observer.shape_deviation(k)}});
  }
  return points;
}

io::Json disturbances_json(const steps::Observer& observer) {
  io::JsonArray all;
  const auto& system = observer.filter.system;
  for (std::size_t j = 0; j < observer.disturbances.size(); ++j) {
    const auto& one = observer.disturbances[j];
    const auto& input = observer.plant.inputs[static_cast<std::size_t>(one.input)];
    all.push_back(io::JsonObject{{"name", one.name},
                                 {"input", input.name},
                                 {"unit", input.unit},
                                 {"rms", one.rms},
                                 {"density", one.density},
                                 {"band_hz", io::JsonArray{one.low_hz, one.high_hz}},
                                 {"drifts", one.course == modal::DisturbanceCourse::drift},
                                 {"noise_rms", system.noise_rms(static_cast<Eigen::Index>(j))}});
  }
  return all;
}

io::Json poles_json(const steps::Observer& observer) {
  io::JsonArray poles;
  for (const auto& pole : observer.filter.pole) {
    if (pole.imag() < 0.0) continue;
    const auto s = std::log(pole) / observer.sample_time_s;
    poles.push_back(io::JsonObject{{"real", pole.real()},
                                   {"imaginary", pole.imag()},
                                   {"frequency_hz", std::abs(s) / kTwoPi},
                                   {"damping_ratio", -s.real() / std::abs(s)}});
  }
  return poles;
}

io::Json modes_json(const steps::Observer& observer) {
  io::JsonArray modes;
  const auto& frequency = steps::identified_of(*observer.shapes).found.fit.model.frequency_hz;
  for (Eigen::Index m = 0; m < frequency.size(); ++m) {
    modes.push_back(
        io::JsonObject{{"frequency_hz", frequency(m)}, {"unknown_part", observer.unknown_part(m)}});
  }
  return modes;
}

io::JsonObject noise_json(const steps::Observer& observer) {
  const auto& noise = observer.noise;
  return {{"learned", noise.is_learned()},
          {"disturbances_over_stated", noise.disturbances},
          {"sensors_over_stated", noise.sensors},
          {"log_likelihood_gain", noise.gain},
          {"left_out_sensors_over_stated", io::Json(observer.left_out)},
          {"band_factor", observer.band_factor}};
}

io::Json replay_json(const steps::Replay& replay, const steps::Replay& stated) {
  io::JsonArray judges;
  for (const auto& one : replay.judges) {
    judges.push_back(io::JsonObject{{"name", one.judge},
                                    {"rms_m", one.rms},
                                    {"own_noise", one.noise},
                                    {"observer", one.observer},
                                    {"prediction", one.prediction},
                                    {"static_interpolation", one.interpolation},
                                    {"static_modes", one.interpolation_modes},
                                    {"rigid_body", one.rigid},
                                    {"model_without_sensors", one.model},
                                    {"filter_of_the_truth", one.truth},
                                    {"covered", one.covered},
                                    {"covered_widened", one.covered_widened}});
  }
  return io::JsonObject{{"judges", judges},
                        {"seconds", replay.seconds},
                        {"settle_s", replay.settle_s},
                        {"innovations_over_stated", stated.surprise},
                        {"innovations_over_stated_per_sensor", io::Json(stated.surprise_of)},
                        {"notes", io::Json::texts(replay.notes)}};
}

void write_model(const study::Study& study, const steps::Observer& observer, Run& run) {
  const auto& filter = observer.filter;
  const auto model = modal::observer_model(filter);
  io::write_mat(run / "observer.mat",
                {{"observer", io::control_model_mat(model)},
                 {"disturbed_model", io::control_model_mat(filter.system.model)},
                 {"L", filter.gain},
                 {"L_points", filter.point_gain},
                 {"P", filter.covariance},
                 {"innovation_covariance", filter.innovation},
                 {"points_covariance", filter.point_covariance},
                 {"noise_rms", Eigen::MatrixXd(filter.system.noise_rms)},
                 {"sensor_rms", Eigen::MatrixXd(filter.system.sensor_rms)},
                 {"points", observer.names()},
                 {"shape_deviation", Eigen::MatrixXd(observer.shape_deviation)}});
  io::CHeaderText text{study.title, {}};
  text.prefix = "chladni_observer";
  write_atomically(run / "observer.h", io::control_model_c(model, text));
}

std::pair<double, std::string> unit_of(double metres) {
  if (metres >= 1e-3) return {1e3, "mm"};
  return metres >= 1e-6 ? std::pair{1e6, "um"} : std::pair{1e9, "nm"};
}

io::PlotSeries band_series(const steps::ReplayCourse& course, const Eigen::VectorXd& middle,
                           const Eigen::VectorXd& half) {
  return {.name = "95 % band of the estimate",
          .x = course.time_s,
          .y = middle - half,
          .upper = middle + half,
          .style = io::PlotSeries::Style::band,
          .colour = kBlue};
}

io::PlotPanel panel_of(const steps::Replay& replay, Eigen::Index j) {
  const auto& course = replay.course;
  const auto [scale, unit] = unit_of(course.measured.col(j).cwiseAbs().maxCoeff());
  const Eigen::VectorXd half = scale * priors::kTwoSided95 * course.deviation.col(j);
  const Eigen::VectorXd estimate = scale * course.estimate.col(j);
  const auto& one = replay.judges[static_cast<std::size_t>(j)];
  io::PlotPanel panel;
  panel.title = fmt::format("{}, {:.3g} % wrong", one.judge, 100.0 * one.observer);
  panel.x = {.label = "time [s]"};
  panel.y = {.label = "displacement [" + unit + "]"};
  panel.series.push_back(band_series(course, estimate, half));
  panel.series.push_back({.name = "measured, seen by no filter",
                          .x = course.time_s,
                          .y = scale * course.measured.col(j),
                          .upper = {},
                          .style = io::PlotSeries::Style::dots,
                          .colour = kGrey,
                          .width = 0.0});
  panel.series.push_back({.name = "estimated",
                          .x = course.time_s,
                          .y = estimate,
                          .upper = {},
                          .style = io::PlotSeries::Style::line,
                          .colour = kBlue,
                          .width = 1.2});
  return panel;
}

// What is wrong with the estimate, over its band around zero.
io::PlotPanel error_panel_of(const steps::Replay& replay, Eigen::Index j) {
  const auto& course = replay.course;
  const Eigen::VectorXd wrong = course.estimate.col(j) - course.measured.col(j);
  const Eigen::VectorXd half = priors::kTwoSided95 * course.deviation.col(j);
  const auto [scale, unit] = unit_of(std::max(wrong.cwiseAbs().maxCoeff(), half.maxCoeff()));
  const auto& one = replay.judges[static_cast<std::size_t>(j)];
  io::PlotPanel panel;
  panel.title = one.judge + ", estimated less measured";
  if (std::isfinite(one.covered)) {
    panel.title += fmt::format(": {:.3g} % within the band", 100.0 * one.covered);
  }
  panel.x = {.label = "time [s]"};
  panel.y = {.label = "error [" + unit + "]"};
  panel.series.push_back(band_series(course, Eigen::VectorXd::Zero(half.size()), scale * half));
  panel.series.push_back({.name = "estimated less measured",
                          .x = course.time_s,
                          .y = scale * wrong,
                          .upper = {},
                          .style = io::PlotSeries::Style::line,
                          .colour = kVermilion,
                          .width = 1.2});
  return panel;
}

// The last part of what is drawn: some periods of the motion can be told apart there.
steps::Replay shortened(steps::Replay replay) {
  constexpr Eigen::Index kSamples = 400;
  auto& course = replay.course;
  const auto n = std::min(kSamples, course.time_s.size());
  course.time_s = course.time_s.tail(n).eval();
  course.measured = course.measured.bottomRows(n).eval();
  course.estimate = course.estimate.bottomRows(n).eval();
  course.deviation = course.deviation.bottomRows(n).eval();
  return replay;
}

void paint(const steps::Replay& replay, Run& run) {
  run.paint("observer.png", [&](const io::PictureFile& png) {
    const auto shown = shortened(replay);
    io::Plot plot;
    plot.title = "Motion that no sensor of the observer sees";
    plot.columns = 1;
    plot.aspect = 0.4;
    for (Eigen::Index j = 0; j < std::min<Eigen::Index>(4, std::ssize(shown.judges)); ++j) {
      plot.panels.push_back(panel_of(shown, j));
      plot.panels.push_back(error_panel_of(shown, j));
    }
    io::draw_plot(png, plot);
  });
}

}  // namespace

io::JsonObject observer_json(const steps::Observed& observed) {
  const auto& [observer, replay, stated, loop] = observed;
  const auto& system = observer.filter.system;
  io::JsonObject json{{"sample_time_s", observer.sample_time_s},
                      {"states", static_cast<long long>(system.state_count())},
                      {"points", points_json(observer)},
                      {"modes", modes_json(observer)},
                      {"disturbances", disturbances_json(observer)},
                      {"sensor_noise", io::Json(system.sensor_rms)},
                      {"noise", noise_json(observer)},
                      {"innovation_covariance", io::Json::rows(observer.filter.innovation)},
                      {"poles", poles_json(observer)},
                      {"notes", io::Json::texts(observer.notes)}};
  if (replay) json.emplace_back("replay", replay_json(*replay, stated ? *stated : *replay));
  if (stated) json.emplace_back("replay_as_stated", replay_json(*stated, *stated));
  if (loop) json.emplace_back("loop", loop_json(*loop));
  return json;
}

void leave_observer(const study::Study& study, const steps::Observed& observed, Run& run) {
  write_model(study, observed.observer, run);
  if (observed.replay) paint(*observed.replay, run);
  run.leave("observe.json", observer_json(observed), true);
}

}  // namespace chladni::show
