// A pinned beam by its closed-form modes, and what an observer on it is to know.
#pragma once

#include <cmath>
#include <numbers>

#include "placement/observer_layouts.h"
#include "placement/plan.h"
#include "placement/sites.h"

namespace chladni::placement::pinned_beam {

inline constexpr Eigen::Index kModes = 6;
inline constexpr double kLength = 2.0;  // [m]; the beam's mass is 1 kg

// Mode k is √2 sin(kπx/L), at k² times the first frequency.
inline Eigen::MatrixXd shapes_at(const Eigen::VectorXd& x) {
  Eigen::MatrixXd shapes(x.size(), kModes);
  for (Eigen::Index k = 0; k < kModes; ++k) {
    shapes.col(k) = std::numbers::sqrt2 *
                    (static_cast<double>(k + 1) * std::numbers::pi / kLength * x.array()).sin();
  }
  return shapes;
}

inline Lines lines_at(const Eigen::VectorXd& x) {
  Lines lines{Points::Zero(x.size(), 3), Points::Zero(x.size(), 3)};
  lines.position.col(0) = x;
  lines.direction.col(2).setOnes();
  return lines;
}

inline Sites points_of_beam(Eigen::Index count) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(count, 0.0, kLength);
  const auto lines = lines_at(x);
  Sites sites;
  sites.position = lines.position;
  sites.normal = lines.direction;
  sites.patch = Eigen::VectorXi::Zero(count);
  sites.area = Eigen::VectorXd::Constant(count, 1e-3);
  sites.shapes = shapes_at(x);
  sites.slopes = Eigen::MatrixXd::Zero(count, kModes);
  sites.whole.assign(static_cast<std::size_t>(count), 1);
  return sites;
}

inline Structure beam(const Eigen::VectorXd& sensors = {}, const Eigen::VectorXd& actuators = {}) {
  Structure structure;
  structure.frequency_hz = Eigen::VectorXd::LinSpaced(kModes, 1.0, kModes).cwiseAbs2() * 50.0;
  structure.damping_ratio = Eigen::VectorXd::Constant(kModes, 0.01);
  structure.mass_kg = 1.0;
  structure.size = kLength;
  structure.sensors = {lines_at(sensors), shapes_at(sensors), {}};
  structure.actuators = {lines_at(actuators), shapes_at(actuators), {}};
  return structure;
}

inline Eigen::MatrixXd mean_square(const Eigen::MatrixXd& shapes) {
  return shapes.transpose() * shapes / static_cast<double>(shapes.rows());
}

// White forces at 0.3 m and of actuators; sensors of 10 nm at 20 kHz.
inline ObserverTask task_on(const Eigen::MatrixXd& region) {
  const auto structure = beam();
  ObserverTask task;
  task.frequency_hz = structure.frequency_hz;
  task.damping_ratio = structure.damping_ratio;
  task.region = mean_square(region);
  task.fixed = {
      {shapes_at(Eigen::VectorXd::Constant(1, 0.3)).row(0), {.name = "hose", .rms = 0.05}}};
  task.at_actuators = {{.name = "amplifier", .rms = 0.02}};
  task.sensor_rms = 1e-8;
  task.sample_time_s = 5e-5;
  return task;
}

}  // namespace chladni::placement::pinned_beam
