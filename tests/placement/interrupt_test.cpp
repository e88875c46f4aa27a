// Ctrl-C is heard wherever many places or layouts are compared.
#include "base/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>

#include "base/error.h"
#include "placement/determinant.h"
#include "placement/heat_map.h"
#include "placement/interpolation.h"
#include "placement/observer_layouts.h"
#include "tests/placement/plate.h"

namespace chladni::placement {
namespace {

constexpr Eigen::Index kCandidates = 12;

Eigen::MatrixXd candidate_rows() {
  return Eigen::MatrixXd::NullaryExpr(kCandidates, 3, [](Eigen::Index i, Eigen::Index j) {
    return std::cos(static_cast<double>((i + 1) * (j + 1)));
  });
}

Points places() {
  Points position = Points::Zero(kCandidates, 3);
  for (Eigen::Index i = 0; i < kCandidates; ++i) position(i, 0) = 0.01 * static_cast<double>(i);
  return position;
}

class PlacementInterrupt : public testing::Test {
 protected:
  void SetUp() override {
    catch_interrupts();
    ASSERT_EQ(std::raise(SIGINT), 0);
  }
  void TearDown() override { forget_interrupt(); }
};

TEST_F(PlacementInterrupt, IsHeardByTheSearchForTheBestInterpolation) {
  InterpolationProblem problem;
  problem.rows = candidate_rows();
  problem.noise = Eigen::VectorXd::Ones(1);
  problem.prior = {Eigen::MatrixXd::Ones(3, 1), Eigen::MatrixXd::Identity(3, 3)};
  problem.count = 2;
  problem.position = places();
  EXPECT_THROW(static_cast<void>(best_interpolation(problem)), Interrupted);
}

TEST_F(PlacementInterrupt, IsHeardByTheSearchForTheLargestDeterminant) {
  const DeterminantProblem problem{.rows = candidate_rows(),
                                   .prior = Eigen::MatrixXd::Identity(3, 3),
                                   .count = 4,
                                   .position = places()};
  EXPECT_THROW(static_cast<void>(greedy(problem)), Interrupted);
  EXPECT_THROW(static_cast<void>(exchanged(problem, {0, 1, 2, 3})), Interrupted);
  EXPECT_THROW(static_cast<void>(best_determinant(problem)), Interrupted);
}

TEST_F(PlacementInterrupt, IsHeardByTheSearchForAnObserversDevices) {
  ObserverTask task;
  task.frequency_hz = Eigen::Vector3d(50.0, 120.0, 210.0);
  task.damping_ratio = Eigen::VectorXd::Constant(3, 0.01);
  task.region = Eigen::MatrixXd::Identity(3, 3);
  task.at_actuators = {{.name = "amplifier", .rms = 0.02}};
  task.sensor_rms = 1e-9;
  task.sample_time_s = 1e-4;
  const ObserverProblem problem{.task = task,
                                .rows = candidate_rows(),
                                .sensors = Eigen::MatrixXd(0, 3),
                                .actuators = candidate_rows().topRows(1),
                                .counts = {.sensors = 2},
                                .position = places()};
  EXPECT_THROW(static_cast<void>(best_observer(problem)), Interrupted);
}

TEST_F(PlacementInterrupt, IsHeardByTheMaps) {
  PairView view;
  view.groups = {{0, 1}};
  view.shapes = candidate_rows().leftCols(1);
  EXPECT_THROW(static_cast<void>(heat_map(*criteria().front(), views_of({view}), Over::worst)),
               Interrupted);
}

TEST_F(PlacementInterrupt, IsHeardByTheSurface) {
  forget_interrupt();
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  ASSERT_EQ(std::raise(SIGINT), 0);
  EXPECT_THROW(static_cast<void>(sampler.surface({"top"})), Interrupted);
}

}  // namespace
}  // namespace chladni::placement
