// The loop of an observer on actuators that count against the sensors.
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "steps/observer/deviations.h"
#include "steps/observer_loop.h"

namespace chladni::steps {
namespace {

// A body that is free along z, with a mode at 200 Hz: two sensors, one actuator.
// side −1: a positive command pushes against the actuator's direction.
IdentifiedModel one_actuator(int side) {
  IdentifiedModel model;
  auto& fit = model.found.fit;
  fit.model.rigid_count = 1;
  fit.model.frequency_hz = Eigen::Vector2d(0.0, 200.0);
  fit.model.damping_ratio = Eigen::Vector2d(0.0, 0.02);
  fit.model.output_shapes = Eigen::MatrixXd{{0.7, 0.9}, {0.7, -0.4}};
  fit.model.input_shapes = Eigen::MatrixXd{{0.7}, {0.5}};
  fit.model.residual = Eigen::MatrixXd::Zero(2, 1);
  fit.mode_covariance.assign(2, Eigen::MatrixXd::Zero(5, 5));
  model.match.shapes = fit.model.output_shapes;
  model.match.input_shapes = fit.model.input_shapes;
  model.match.modes.resize(2);
  for (auto& mode : model.match.modes) mode.sign = side;
  model.match.side = side;
  fit.model.input_shapes *= side;
  model.seen.outputs.resize(2);
  model.seen.inputs.resize(1);
  model.seen.inputs[0].name = "a1";
  return model;
}

// That body with one point.
Observer pushed(int side) {
  auto model = one_actuator(side);
  const auto& fit = model.found.fit;
  Observer observer;
  observer.places.points = {"q"};
  observer.places.at_points = {Eigen::MatrixXd{{0.7, 1.2}}, Eigen::MatrixXd::Zero(1, 2),
                               Eigen::MatrixXd::Zero(1, 1)};
  observer.sample_time_s = 2e-4;
  observer.plant = identification::observed_plant(fit, model.match, model.seen.outputs,
                                                  model.seen.inputs, observer.places);
  identification::ObservedPlaces unit;
  unit.points = {"q1", "q2"};
  unit.at_points = {Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(2, 2),
                    Eigen::MatrixXd::Zero(2, 1)};
  observer.coordinates =
      identification::observed_plant(fit, model.match, model.seen.outputs, model.seen.inputs, unit)
          .space.c.bottomRows(2);
  observer.disturbances = {{.name = "w", .input = 0, .rms = 0.02}};
  observer.filter = modal::kalman_filter(
      modal::disturbed_model(observer.plant, 1, observer.disturbances,
                             Eigen::VectorXd::Constant(2, 1e-9), observer.sample_time_s));
  Interpolated shapes;
  shapes.measured.identified = std::make_shared<const IdentifiedModel>(std::move(model));
  observer.shapes = std::make_shared<const Interpolated>(std::move(shapes));
  set_deviations(observer);
  return observer;
}

// The loop on the sensors was unstable, and points moved against the sensors.
TEST(TurnedLoop, LeavesTheMotionThatActuatorsAlongTheirDirectionsLeave) {
  study::Study study;
  study.observer.emplace();
  study.observer->loop.emplace();
  study.observer->loop->actuators = {"a1"};
  study.observer->loop->bandwidth_hz = 20.0;
  stage::Work work;
  const auto along = loop_trial(study, pushed(1), work);
  const auto against = loop_trial(study, pushed(-1), work);
  for (const auto* trial : {&along, &against}) {
    EXPECT_EQ(trial->axes, 1);
    EXPECT_TRUE(trial->on_sensors.stable);
    EXPECT_TRUE(trial->on_estimate.stable);
    EXPECT_EQ(trial->on_sensors.stable_draws, kLoopDraws);
    EXPECT_EQ(trial->on_estimate.stable_draws, kLoopDraws);
  }
  const auto expect_same = [](const LoopCase& one, const LoopCase& other) {
    EXPECT_NEAR(one.rms.at(0) / other.rms.at(0), 1.0, 1e-6);
    EXPECT_NEAR(one.modulus_margin / other.modulus_margin, 1.0, 1e-6);
  };
  expect_same(against.on_sensors, along.on_sensors);
  expect_same(against.on_estimate, along.on_estimate);
}

}  // namespace
}  // namespace chladni::steps
