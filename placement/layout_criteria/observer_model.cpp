#include "placement/observer_model.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "base/error.h"
#include "base/turn.h"
#include "dense/riccati.h"
#include "modal/groups.h"
#include "placement/constants.h"

namespace chladni::placement {
namespace {

void require_sound(const ObserverTask& task) {
  const auto modes = task.frequency_hz.size();
  require(
      modes > 0 && task.damping_ratio.size() == modes && task.region.rows() == modes &&
          task.region.cols() == modes && task.rigid_count >= 0 && task.rigid_count <= modes,
      "observer of a layout: the frequencies, damping ratios and shapes of the region do not fit "
      "together");
  require(task.region.allFinite() && task.region.trace() > 0.0,
          "observer of a layout: no mode moves the region; expected points on the body that move "
          "along the direction of the devices");
  require(
      !task.fixed.empty() || !task.at_actuators.empty(),
      "observer of a layout: no disturbance is stated; expected one at least, since without one "
      "everything is known");
  require(
      std::isfinite(task.sensor_rms) && task.sensor_rms > 0.0,
      fmt::format("observer of a layout: the noise of the sensors is {} m; expected an rms above 0",
                  task.sensor_rms));
  require(std::isfinite(task.effort) && task.effort >= 0.0,
          "observer of a layout: the effort of a force is negative or not finite");
  const auto flexible = modes - task.rigid_count;
  require(
      flexible == 0 || task.damping_ratio.tail(flexible).minCoeff() > 0.0,
      "observer of a layout: a mode has no damping, and its motion no bound where no sensor sees "
      "it; expected modes.damping_ratio above 0");
  const double first = flexible > 0 ? task.frequency_hz(task.rigid_count) : INFINITY;
  require(task.rigid_count == 0 || (task.suspension_hz > 0.0 && task.suspension_hz < first),
          fmt::format("observer of a layout: rigid-body modes are held at {:.6g} Hz; expected a "
                      "frequency above 0 and below the first flexible mode, {:.6g} Hz",
                      task.suspension_hz, first));
  for (const auto& one : task.fixed) {
    require(one.shape.size() == modes && one.shape.allFinite(),
            "observer of a layout: disturbance \"" + one.course.name + "\" does not fit the modes");
  }
}

// Modes of one group get its mean: what splits repeated modes is not known.
modal::ReducedModel held_modes(const ObserverTask& task) {
  modal::ReducedModel model;
  model.frequency_hz = task.frequency_hz;
  model.damping_ratio = task.damping_ratio;
  const auto rigid = task.rigid_count;
  const auto flexible = task.frequency_hz.size() - rigid;
  model.frequency_hz.head(rigid).setConstant(task.suspension_hz);
  model.damping_ratio.head(rigid).setConstant(Constants::suspension_damping);
  for (const auto& [first, size] :
       modal::groups(task.frequency_hz.tail(flexible), task.frequency_tolerance)) {
    for (auto* values : {&model.frequency_hz, &model.damping_ratio}) {
      auto part = values->segment(rigid + first, size);
      part.setConstant(part.mean());
    }
  }
  const auto modes = task.frequency_hz.size();
  model.output_shapes = Eigen::MatrixXd::Identity(modes, modes);
  model.input_shapes = Eigen::MatrixXd::Ones(modes, 1);
  model.residual = Eigen::MatrixXd::Zero(modes, 1);
  model.dampers = {Eigen::MatrixXd(0, modes), Eigen::MatrixXd(modes, 0), Eigen::MatrixXd(0, 1),
                   Eigen::MatrixXd(0, 0)};
  return model;
}

// All modes under one force that each has with a shape of 1: the known input, and the disturbance.
modal::DisturbedModel unit_model(const ObserverTask& task, modal::Disturbance course) {
  const auto model = held_modes(task);
  std::vector<modal::OutputChannel> outputs;
  for (Eigen::Index k = 0; k < model.mode_count(); ++k) {
    outputs.push_back({fmt::format("coordinate_{}", k + 1)});
  }
  course.input = 0;
  const Eigen::VectorXd one_sensor = Eigen::VectorXd::Ones(1);
  return modal::disturbed_model(modal::control_model(model, outputs, {"force"}), 1, {course},
                                one_sensor, task.sample_time_s);
}

// A drift as noise that forgets its level in a hundred of its times: it then has a variance without
// sensors, and changes as before from sample to sample.
modal::Disturbance forgetful(modal::Disturbance course) {
  const double times = Constants::drift_memory;
  if (course.course != modal::DisturbanceCourse::drift) return course;
  course.course = modal::DisturbanceCourse::band;
  course.low_hz = 0.0;
  course.high_hz = 1.0 / (kTwoPi * times * course.drift_time_s);
  course.rms *= std::sqrt(0.5 * times);
  return course;
}

// Deviations of states under their noise.
Eigen::VectorXd deviations(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return dense::stationary_covariance(a, b * b.transpose()).diagonal().cwiseSqrt();
}

// Each mode's two entries, over 2r.
Eigen::VectorXd twice(const Eigen::RowVectorXd& shape) {
  Eigen::VectorXd both(2 * shape.size());
  for (Eigen::Index k = 0; k < shape.size(); ++k) both.segment<2>(2 * k).setConstant(shape(k));
  return both;
}

double trace_of(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.cwiseProduct(b).sum();
}

// The gain of the best loop: u = −K x, with a weight of 1 on each force.
struct Regulator {
  Eigen::MatrixXd cost;   // S
  Eigen::MatrixXd gain;   // K
  Eigen::MatrixXd error;  // what an error of the states costs
};

Regulator regulator(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                    const Eigen::MatrixXd& weight) {
  const auto n = a.rows();
  const auto q = b.cols();
  Regulator result;
  if (q == 0) {
    result.cost = dense::stationary_covariance(a.transpose(), weight);
    result.gain = Eigen::MatrixXd::Zero(0, n);
    result.error = Eigen::MatrixXd::Zero(n, n);
    return result;
  }
  result.cost =
      dense::prediction_covariance({a.transpose(), b.transpose(), weight,
                                    Eigen::MatrixXd::Identity(q, q), Eigen::MatrixXd::Zero(n, q)});
  const Eigen::MatrixXd seen = result.cost * b;
  const Eigen::MatrixXd worth = b.transpose() * seen + Eigen::MatrixXd::Identity(q, q);
  result.gain = worth.llt().solve(Eigen::MatrixXd(seen.transpose() * a));
  result.error = result.gain.transpose() * worth * result.gain;
  return result;
}

}  // namespace

ObserverModel::ObserverModel(const ObserverTask& task) : region_(task.region) {
  require_sound(task);
  sensor_rms_ = task.sensor_rms;
  effort_ = task.effort;
  const auto states = 2 * mode_count();
  const modal::Disturbance white{.name = "white", .rms = 1.0};
  const auto unit = unit_model(task, white);
  const auto& space = unit.model.space;
  const Eigen::VectorXd held = unit.known_inputs();
  scale_ = deviations(space.a, held);
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  modes_ = inverse.asDiagonal() * space.a * scale_.asDiagonal();
  read_ = space.c * scale_.asDiagonal();
  held_ = inverse.asDiagonal() * held;
  require(modes_.rows() == states, "observer of a layout: the model has states beside its modes");
  for (const auto& one : task.fixed) fixed_.emplace_back(one.shape, sampled(one.course, task));
  for (const auto& course : task.at_actuators) at_actuators_.push_back(sampled(course, task));
}

ObserverModel::Course ObserverModel::sampled(const modal::Disturbance& course,
                                             const ObserverTask& task) const {
  const auto unit = unit_model(task, forgetful(course));
  const auto& a = unit.model.space.a;
  const Eigen::VectorXd noise = unit.noise_inputs();
  const auto states = 2 * mode_count();
  const auto own = a.rows() - states;
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  Course result;
  result.a = a.bottomRightCorner(own, own);
  result.b = noise.tail(own);
  result.at_once = inverse.asDiagonal() * noise.head(states);
  result.on_modes = inverse.asDiagonal() * a.topRightCorner(states, own);
  if (own == 0) return result;
  const Eigen::VectorXd size = deviations(result.a, result.b);
  result.a = (size.cwiseInverse().asDiagonal() * result.a * size.asDiagonal()).eval();
  result.b = result.b.cwiseQuotient(size).eval();
  result.on_modes = (result.on_modes * size.asDiagonal()).eval();
  return result;
}

// The filter of some sensors in steady state.
struct ObserverModel::Filter {
  Eigen::MatrixXd before;      // n×n: covariance of the states given the samples before
  Eigen::MatrixXd innovation;  // s×s
  Eigen::MatrixXd gain;        // n×s

  [[nodiscard]] Eigen::MatrixXd known() const {
    return before - gain * innovation * gain.transpose();
  }
};

ObserverModel::Filter ObserverModel::filtered(const Disturbed& system,
                                              const Eigen::MatrixXd& sensors) const {
  const auto n = system.a.rows();
  const auto p = sensors.rows();
  if (p == 0) {
    return {dense::stationary_covariance(system.a, system.q()), Eigen::MatrixXd(0, 0),
            Eigen::MatrixXd(n, 0)};
  }
  const Eigen::MatrixXd c = seen(sensors, n);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(p, p);
  Filter filter;
  filter.before =
      dense::prediction_covariance({system.a, c, system.q(), one, Eigen::MatrixXd::Zero(n, p)});
  filter.innovation = c * filter.before * c.transpose() + one;
  filter.gain = filter.innovation.llt().solve(Eigen::MatrixXd(c * filter.before)).transpose();
  return filter;
}

ObserverModel::Disturbed ObserverModel::disturbed(const Eigen::MatrixXd& actuators) const {
  std::vector<std::pair<Eigen::VectorXd, const Course*>> all;
  for (const auto& [shape, course] : fixed_) all.emplace_back(twice(shape), &course);
  for (Eigen::Index j = 0; j < actuators.rows(); ++j) {
    for (const auto& course : at_actuators_) all.emplace_back(twice(actuators.row(j)), &course);
  }
  const auto states = 2 * mode_count();
  auto n = states;
  for (const auto& [shape, course] : all) n += course->a.rows();
  Disturbed result{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, std::ssize(all))};
  result.a.topLeftCorner(states, states) = modes_;
  auto at = states;
  for (std::size_t j = 0; j < all.size(); ++j) {
    const auto& [shape, course] = all[j];
    const auto column = static_cast<Eigen::Index>(j);
    const auto own = course->a.rows();
    result.a.block(0, at, states, own) = shape.asDiagonal() * course->on_modes;
    result.a.block(at, at, own, own) = course->a;
    result.noise.col(column).head(states) = shape.cwiseProduct(course->at_once);
    result.noise.col(column).segment(at, own) = course->b;
    at += own;
  }
  return result;
}

Eigen::MatrixXd ObserverModel::coordinates(Eigen::Index n) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(mode_count(), n);
  all.leftCols(read_.cols()) = read_;
  return all;
}

Eigen::MatrixXd ObserverModel::seen(const Eigen::MatrixXd& shapes, Eigen::Index n) const {
  return shapes / sensor_rms_ * coordinates(n);
}

Eigen::MatrixXd ObserverModel::moved(const Eigen::MatrixXd& shapes, Eigen::Index n) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, shapes.rows());
  for (Eigen::Index j = 0; j < shapes.rows(); ++j) {
    all.col(j).head(held_.size()) = twice(shapes.row(j)).cwiseProduct(held_) / effort_;
  }
  return all;
}

Eigen::MatrixXd ObserverModel::weight(Eigen::Index n) const {
  const Eigen::MatrixXd read = coordinates(n);
  const Eigen::MatrixXd all = read.transpose() * region_ * read;
  return 0.5 * (all + all.transpose());
}

ObserverValue ObserverModel::value(const Eigen::MatrixXd& sensors,
                                   const Eigen::MatrixXd& actuators) const {
  for (const auto* rows : {&sensors, &actuators}) {
    require(rows->rows() == 0 || rows->cols() == mode_count(),
            "observer of a layout: a device has another number of modes than the body");
  }
  const auto system = disturbed(actuators);
  const auto n = system.a.rows();
  const Eigen::MatrixXd w = weight(n);
  const auto filter = filtered(system, sensors);
  ObserverValue result;
  result.without = trace_of(w, dense::stationary_covariance(system.a, system.q()));
  result.prediction = trace_of(w, filter.before);
  result.estimate = trace_of(w, filter.known());
  result.coordinates = coordinates(n) * filter.known() * coordinates(n).transpose();
  if (!has_loop()) return result;
  const Eigen::MatrixXd b = moved(actuators, n);
  const auto loop = regulator(system.a, b, w);
  // The state that the loop knows moves by innovations; what it does not know is its error. Without
  // a sensor it knows all.
  const bool blind = sensors.rows() == 0;
  const Eigen::MatrixXd unknown = blind ? Eigen::MatrixXd::Zero(n, n) : filter.before;
  const Eigen::MatrixXd ahead = system.a * filter.gain;
  const Eigen::MatrixXd moves =
      blind ? system.q() : Eigen::MatrixXd(ahead * filter.innovation * ahead.transpose());
  const Eigen::MatrixXd held = dense::stationary_covariance(system.a - b * loop.gain, moves);
  result.loop = trace_of(loop.cost, system.q()) + trace_of(loop.error, unknown);
  result.loop_motion = trace_of(w, held + unknown);
  result.loop_force_n2 = (loop.gain * held * loop.gain.transpose()).trace() / (effort_ * effort_);
  return result;
}

Eigen::VectorXd estimate_deviation(const Eigen::MatrixXd& coordinates,
                                   const Eigen::MatrixXd& places) {
  return (places * coordinates).cwiseProduct(places).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace chladni::placement
