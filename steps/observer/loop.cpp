// Feedback on the estimate against feedback on the sensors, on the model and on drawn models.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/draw.h"
#include "base/error.h"
#include "base/turn.h"
#include "dense/algebra.h"
#include "modal/feedback.h"
#include "recordings/virtual_experiment.h"
#include "steps/observer/drawn.h"
#include "steps/observer_loop.h"
#include "steps/predicted.h"

namespace chladni::steps {
namespace {

constexpr Eigen::Index kLines = 60;  // of the margin, beside those at resonances

Eigen::VectorXd margin_lines(const Observer& observer) {
  return Eigen::VectorXd::LinSpaced(kLines, std::log(0.5), std::log(0.5 / observer.sample_time_s))
      .array()
      .exp();
}

// The lowest modes: the body on its suspension, or free.
Eigen::Index axes_of(const identification::ModalFit& fit, double bandwidth_hz) {
  const auto axes = (fit.model.frequency_hz.array() < 0.5 * bandwidth_hz).count();
  require(
      axes > 0,
      fmt::format("observer.loop: no mode lies below half of the bandwidth, {:.6g} Hz; expected "
                  "a bandwidth above twice that of the suspension, {:.6g} Hz",
                  0.5 * bandwidth_hz, fit.model.frequency_hz(0)));
  return axes;
}

// The places of the observer with the coordinates of the axes as further points.
identification::ObservedPlaces with_axes(const identification::ObservedPlaces& places,
                                         Eigen::Index axes, bool complex) {
  auto result = places;
  auto& rows = result.at_points;
  const auto m = rows.shapes.cols();
  const auto n = rows.shapes.rows();
  const auto add = [&](Eigen::MatrixXd& matrix, const Eigen::MatrixXd& below) {
    matrix.conservativeResize(n + axes, matrix.cols());
    matrix.bottomRows(axes) = below;
  };
  for (Eigen::Index k = 0; k < axes; ++k) result.points.push_back(fmt::format("axis_{}", k + 1));
  add(rows.shapes, Eigen::MatrixXd::Identity(axes, m));
  add(rows.residual, Eigen::MatrixXd::Zero(axes, rows.residual.cols()));
  if (complex) add(rows.imaginary, Eigen::MatrixXd::Zero(axes, m));
  return result;
}

// The law with the coordinates of the axes in and the forces of the actuators out.
modal::FeedbackLaw law_of(const IdentifiedModel& model, Eigen::Index axes,
                          const std::vector<Eigen::Index>& actuators, double bandwidth_hz,
                          double sample_time_s) {
  auto unit = model.found.fit.model;
  unit.output_shapes = Eigen::MatrixXd::Identity(axes, unit.mode_count());
  unit.input_shapes = identification::driving_shapes(model.match);
  unit.residual = Eigen::MatrixXd::Zero(axes, unit.input_count());
  const auto law = recordings::stabiliser(unit, axes, actuators, bandwidth_hz, sample_time_s);
  return {law.a, law.b, law.c, law.d};
}

std::vector<Eigen::Index> driven(const study::Study& study, const IdentifiedModel& model) {
  std::vector<Eigen::Index> actuators;
  for (const auto& name : study.observer->loop->actuators) {
    actuators.push_back(index_of(model.seen.inputs, name));
    require(actuators.back() >= 0,
            "observer.loop: \"" + name + "\" is held out of the fit; expected an actuator of it");
  }
  return actuators;
}

// The whole samples, one or more, that the computer takes.
Eigen::Index samples_of(double delay_s, double sample_time_s) {
  constexpr double kMost = 1000.0;  // each is a state of the loop
  const double samples = std::ceil(delay_s / sample_time_s - 1e-9);
  require(samples <= kMost,
          fmt::format("observer.loop: a delay of {:.4g} s is {:.4g} samples; expected at most {:g} "
                      "samples",
                      delay_s, samples, kMost));
  return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(samples));
}

// What both loops share, and the model that they run on.
struct LoopModels {
  modal::DisturbedModel nominal;
  modal::Feedback sensors, estimate;
};

// The plant under the noise that the observer counts on; its sensors have it already.
modal::DisturbedModel disturbed(const Observer& observer, const modal::ControlModel& plant) {
  const auto& system = observer.filter.system;
  auto result = modal::disturbed_model(plant, system.known, observer.disturbances,
                                       system.sensor_rms, observer.sample_time_s);
  result.noise_rms *= observer.noise.disturbances;
  return result;
}

modal::ControlModel plant_with_axes(const Observer& observer, const identification::ModalFit& fit,
                                    const identification::ObservedPlaces& places) {
  const auto& model = identified_of(*observer.shapes);
  auto plant = identification::observed_plant(fit, model.match, model.seen.outputs,
                                              model.seen.inputs, places);
  plant.input_delay = observer.plant.input_delay;
  plant.output_delay.head(observer.plant.output_delay.size() - std::ssize(observer.names())) =
      observer.plant.output_delay.head(observer.plant.output_delay.size() -
                                       std::ssize(observer.names()));
  return plant;
}

LoopModels loop_models(const study::Study& study, const Observer& observer, LoopTrial& trial) {
  const auto& model = identified_of(*observer.shapes);
  const auto& plan = *study.observer->loop;
  const auto& fit = model.found.fit;
  const auto axes = trial.axes;
  const auto p = std::ssize(model.seen.outputs);
  require(p >= axes,
          fmt::format("observer.loop: {} sensors for {} axes; expected as many or more", p, axes));
  for (const auto& output : model.seen.outputs) {
    require(output.kind == modal::FrfKind::receptance,
            "observer.loop: the loop on the sensors needs sensors of displacement; \"" +
                output.name + "\" is none");
  }
  const auto places = with_axes(observer.places, axes, fit.complex.has_value());
  LoopModels result;
  result.nominal = disturbed(observer, plant_with_axes(observer, fit, places));
  auto& sensors = result.sensors;
  sensors.actuators = driven(study, model);
  sensors.law = law_of(model, axes, sensors.actuators, plan.bandwidth_hz, observer.sample_time_s);
  sensors.sensors = dense::pseudo_inverse(model.match.shapes.topRows(p).leftCols(axes));
  sensors.delay = samples_of(plan.delay, observer.sample_time_s);
  trial.delay_s = static_cast<double>(sensors.delay) * observer.sample_time_s;
  result.estimate = sensors;
  result.estimate.sensors.resize(0, 0);
  result.estimate.filter = modal::kalman_filter(result.nominal);
  // The first point moves by φ q of the axes and its flexible part: the law sees axes that move it
  // as it is estimated to move.
  const auto n = std::ssize(observer.names());
  const Eigen::RowVectorXd at_point = observer.places.at_points.shapes.row(0).head(axes);
  const Eigen::VectorXd back = dense::pseudo_inverse(at_point);
  auto& points = result.estimate.points = Eigen::MatrixXd::Zero(axes, n + axes);
  points.rightCols(axes) = Eigen::MatrixXd::Identity(axes, axes) - back * at_point;
  points.col(0) = back;
  return result;
}

std::vector<double> listed(const Eigen::VectorXd& rms, Eigen::Index count) {
  if (rms.size() == 0) {
    return std::vector<double>(static_cast<std::size_t>(count),
                               std::numeric_limits<double>::quiet_NaN());
  }
  return {rms.data(), rms.data() + count};
}

double margin_of(const modal::DisturbedModel& plant, const modal::Feedback& feedback,
                 const modal::ClosedLoop& loop, const Eigen::VectorXd& lines) {
  return modal::modulus_margin(
      plant, feedback, modal::with_resonances(lines, loop.pole, plant.model.space.sample_time_s));
}

LoopCase nominal_case(const LoopModels& models, const modal::Feedback& feedback,
                      const Eigen::VectorXd& lines, Eigen::Index points) {
  const auto loop = modal::closed_loop(models.nominal, feedback);
  LoopCase result;
  result.stable = loop.spectral_radius < 1.0;
  result.rms = listed(loop.rms, points);
  if (result.stable) {
    result.modulus_margin = margin_of(models.nominal, feedback, loop, lines);
  }
  return result;
}

// The rms of each drawn model, sorted at each point; infinite where the loop is unstable.
class Draws {
 public:
  explicit Draws(Eigen::Index points) : rms_(static_cast<std::size_t>(points)) {}

  void add(const modal::DisturbedModel& plant, const modal::Feedback& feedback,
           const Eigen::VectorXd& lines) {
    const auto loop = modal::closed_loop(plant, feedback);
    if (!(loop.spectral_radius < 1.0)) {
      worst_margin_ = 0.0;
      for (auto& all : rms_) all.push_back(std::numeric_limits<double>::infinity());
      return;
    }
    ++stable_;
    worst_margin_ = std::min(worst_margin_, margin_of(plant, feedback, loop, lines));
    for (std::size_t i = 0; i < rms_.size(); ++i) {
      rms_[i].push_back(loop.rms(static_cast<Eigen::Index>(i)));
    }
  }

  void tell(LoopCase& into) {
    into.stable_draws = stable_;
    into.worst_margin = stable_ > 0 ? worst_margin_ : 0.0;
    for (auto& all : rms_) {
      if (all.empty()) continue;
      std::ranges::sort(all);
      into.median_rms.push_back(all[all.size() / 2]);
      into.worst_rms.push_back(all.back());
    }
  }

 private:
  int stable_ = 0;
  double worst_margin_ = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> rms_;
};

}  // namespace

LoopTrial loop_trial(const study::Study& study, const Observer& observer, stage::Work& work) {
  const auto& model = identified_of(*observer.shapes);
  const auto& fit = model.found.fit;
  LoopTrial trial;
  trial.bandwidth_hz = study.observer->loop->bandwidth_hz;
  trial.axes = axes_of(fit, trial.bandwidth_hz);
  trial.points = observer.names();
  trial.open_rms = listed(observer.without, observer.without.size());
  const auto models = loop_models(study, observer, trial);
  const auto lines = margin_lines(observer);
  const auto points = std::ssize(trial.points);
  trial.on_sensors = nominal_case(models, models.sensors, lines, points);
  trial.on_estimate = nominal_case(models, models.estimate, lines, points);
  if (fit.complex) {
    trial.notes.emplace_back("no models are drawn: those of complex shapes are not implemented");
    return trial;
  }
  if (const auto unknown = unknown_numbers(model, observer.places.at_points.deviation);
      unknown > 0) {
    trial.notes.push_back(
        fmt::format("drawn models: {} numbers of poles and shapes have no known deviation; each is "
                    "drawn with its own size as deviation",
                    unknown));
  }
  Draw draw(work.seed());
  Draws on_sensors(points);
  Draws on_estimate(points);
  const auto places = with_axes(observer.places, trial.axes, false);
  for (int k = 0; k < kLoopDraws; ++k) {
    tell(work.progress(), "drawn models", static_cast<double>(k) / kLoopDraws);
    const auto other = drawn_fit(model, draw);
    const auto plant = disturbed(
        observer, plant_with_axes(observer, other, drawn_places(places, observer, other, draw)));
    on_sensors.add(plant, models.sensors, lines);
    on_estimate.add(plant, models.estimate, lines);
  }
  work.clear_progress();
  trial.draws = kLoopDraws;
  on_sensors.tell(trial.on_sensors);
  on_estimate.tell(trial.on_estimate);
  return trial;
}

}  // namespace chladni::steps
