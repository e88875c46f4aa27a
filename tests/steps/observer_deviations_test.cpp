// What an observer says that its sensors leave unknown of the modes.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "steps/observer/deviations.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

// A body of a mode at `first_hz` and two above it, which two actuators shake; the one sensor sees
// nothing of the last. The second actuator drifts, too, where `drift` is its rms.
Observer shaken(double first_hz, double drift = 0.0) {
  const bool is_free = first_hz == 0.0;
  identification::ModalFit fit;
  auto& model = fit.model;
  model.rigid_count = is_free ? 1 : 0;
  model.frequency_hz = Eigen::Vector3d(first_hz, 40.0, 90.0);
  model.damping_ratio = Eigen::Vector3d(is_free ? 0.0 : 0.02, 0.02, 0.03);
  model.output_shapes = Eigen::RowVector3d(0.5, 0.8, 0.0);
  model.input_shapes = Eigen::MatrixXd{{0.5, 0.4}, {0.9, -0.3}, {0.2, 0.7}};
  model.residual = Eigen::MatrixXd::Zero(1, 2);
  identification::GainMatch match;
  match.input_shapes = model.input_shapes;
  std::vector<modal::MeasuredChannel> outputs(1), inputs(2);
  Observer observer;
  observer.places.points = {"q1", "q2", "q3"};
  observer.places.at_points = {Eigen::MatrixXd::Identity(3, 3), Eigen::MatrixXd::Zero(3, 3),
                               Eigen::MatrixXd::Zero(3, 2)};
  const auto plant = identification::observed_plant(fit, match, outputs, inputs, observer.places);
  observer.coordinates = plant.space.c.bottomRows(3);
  std::vector<modal::Disturbance> disturbances;
  for (Index j = 0; j < 2; ++j) {
    disturbances.push_back({.name = "w", .input = j, .rms = 1.0});
  }
  if (drift > 0.0) {
    disturbances.push_back({.name = "d",
                            .input = 1,
                            .course = modal::DisturbanceCourse::drift,
                            .rms = drift,
                            .drift_time_s = 10.0});
  }
  observer.filter = modal::kalman_filter(
      modal::disturbed_model(plant, 2, disturbances, Eigen::VectorXd::Constant(1, 1e-7), 1e-3));
  set_deviations(observer);
  return observer;
}

// That the body drifts as a whole says nothing of its other modes.
TEST(ObserverDeviations, TellModesThatNoSensorSeesWhereTheBodyDrifts) {
  const auto held = shaken(1.0);
  const auto drifting = shaken(0.0);
  for (const auto* one : {&held, &drifting}) {
    EXPECT_LT(one->unknown_part(1), 0.5);
    EXPECT_GT(one->unknown_part(2), 0.5);
    EXPECT_LE(one->unknown_part(2), 1.0 + 1e-9);
  }
  EXPECT_GT(held.unknown_part(0), 0.0);
  EXPECT_EQ(drifting.unknown_part(0), 0.0);
  EXPECT_TRUE(std::isinf(drifting.without(0)));
}

// A drift moves every mode without bound, of which the samples tell all but the fast rest.
TEST(ObserverDeviations, TellModesThatNoSensorSeesUnderADrift) {
  const auto still = shaken(1.0);
  const auto drifting = shaken(1.0, 1e-2);
  EXPECT_TRUE(std::isinf(drifting.without(0)));
  EXPECT_LT(drifting.unknown_part(1), 0.5);
  EXPECT_NEAR(drifting.unknown_part(2), still.unknown_part(2), 0.1);
  EXPECT_LE(drifting.unknown_part(2), 1.0);
}

// Taken by itself or with all others, a mode is moved as much.
TEST(ObserverDeviations, TakeAModeByItselfAsWithAllOthers) {
  const auto held = shaken(1.0);
  const auto drifting = shaken(0.0);
  const auto amplitude = [](const Observer& one, Index m) {
    const Eigen::RowVectorXd row = one.coordinates.row(m);
    const auto left = one.filter.covariance.topLeftCorner(row.size(), row.size());
    return std::sqrt((row * left).dot(row)) / one.unknown_part(m);
  };
  for (const Index m : {1, 2}) {
    EXPECT_NEAR(amplitude(drifting, m) / amplitude(held, m), 1.0, 1e-6) << m;
  }
}

}  // namespace
}  // namespace chladni::steps
