// A chain of masses under forces that nobody measures, and courses of its motion.
#pragma once

#include <Eigen/Core>

#include "base/draw.h"
#include "modal/disturbed_model.h"
#include "tests/modal/chain.h"

namespace chladni::modal {

inline constexpr double kSampleTime = 2e-4;

// Sensors at masses 0 and 7, wanted at 12 and 19; forces at 2 (known) and 19 (not known).
inline ControlModel continuous(bool held, double damping_ratio = 0.01, Eigen::Index kept = 6) {
  return control_model(reduced(chain(20, held), kept, {0, 7, 12, 19}, {2, 19}, damping_ratio),
                       {{"s1"}, {"s2"}, {"z1"}, {"z2"}}, {"a1", "cable"});
}

inline const Eigen::Vector2d kSensorNoise(2e-9, 3e-9);

inline Disturbance white(double rms) { return {.name = "cable", .input = 1, .rms = rms}; }

inline Eigen::MatrixXd noise(Draw& draw, Eigen::Index samples, const Eigen::VectorXd& rms) {
  Eigen::MatrixXd values(samples, rms.size());
  for (Eigen::Index k = 0; k < samples; ++k) {
    for (Eigen::Index j = 0; j < rms.size(); ++j) values(k, j) = rms(j) * draw.normal();
  }
  return values;
}

struct Course {
  Eigen::MatrixXd inputs, sensors, wanted;
};

// The sampled system itself, with its own noise.
inline Course simulated(const DisturbedModel& system, Eigen::Index samples, unsigned seed) {
  Draw draw(seed);
  const auto& space = system.model.space;
  Course course{noise(draw, samples, Eigen::VectorXd::Ones(system.known)),
                noise(draw, samples, system.sensor_rms),
                Eigen::MatrixXd(samples, system.wanted_count())};
  const auto w = noise(draw, samples, system.noise_rms);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.state_count());
  Eigen::VectorXd u(space.b.cols());
  for (Eigen::Index k = 0; k < samples; ++k) {
    for (Eigen::Index j = 0; j < system.known; ++j) {
      const auto then = k - static_cast<Eigen::Index>(system.model.input_delay(j));
      u(j) = then < 0 ? 0.0 : course.inputs(then, j);
    }
    u.tail(w.cols()) = w.row(k).transpose();
    const Eigen::VectorXd y = space.c * x + space.d * u;
    course.sensors.row(k) += y.head(system.sensors).transpose();
    course.wanted.row(k) = y.tail(system.wanted_count()).transpose();
    x = (space.a * x + space.b * u).eval();
  }
  return course;
}

}  // namespace chladni::modal
