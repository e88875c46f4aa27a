// What the observer of a layout knows of a region: closed forms, an independent filter, simulation.
#include "placement/observer_model.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "base/draw.h"
#include "base/turn.h"
#include "modal/kalman_filter.h"
#include "tests/placement/pinned_beam.h"
#include "tests/refusal.h"

namespace chladni::placement {
namespace {

using namespace pinned_beam;

Eigen::MatrixXd at(std::initializer_list<double> places) {
  return shapes_at(Eigen::Map<const Eigen::VectorXd>(places.begin(), std::ssize(places)));
}

// One mode under a force that is held from sample to sample: q and its velocity, exactly.
struct Oscillator {
  Eigen::Matrix2d a;
  Eigen::Vector2d b;

  Oscillator(double frequency_hz, double damping, double t) {
    const double w = kTwoPi * frequency_hz;
    const double decay = damping * w;
    const double swing = w * std::sqrt(1.0 - damping * damping);
    const double c = std::exp(-decay * t) * std::cos(swing * t);
    const double s = std::exp(-decay * t) * std::sin(swing * t);
    a << c + decay / swing * s, s / swing, -w * w / swing * s, c - decay / swing * s;
    b << (1.0 - a(0, 0)) / (w * w), a(0, 1);
  }
};

using Real = long double;
using Complex = std::complex<Real>;

// The root of z + 1/z = w within the unit circle.
Complex inside(Complex w) {
  const auto root = std::sqrt(w * w - Real{4});
  const auto z = (w + root) / Real{2};
  return std::abs(z) < 1 ? z : (w - root) / Real{2};
}

// The variance of q given this sample and all before, by factors of the spectrum of y = q + noise:
// r D(z) D(1/z) + f N(z) N(1/z) = s E(z) E(1/z), s the variance of the innovation.
double variance_of_one_mode(double frequency_hz, double damping, double t, double force_rms,
                            double noise_rms) {
  const Real w = Real{kTwoPi} * frequency_hz;
  const Real decay = damping * w;
  const Real swing = w * std::sqrt(1 - Real{damping} * damping);
  const Real c = std::exp(-decay * t) * std::cos(swing * t);
  const Real s = std::exp(-decay * t) * std::sin(swing * t) / swing;
  const Real n1 = (1 - c - decay * s) / (w * w);
  const Real n0 = s * s - (c - decay * s) * n1;
  const Real d1 = -2 * c;
  const Real d0 = std::exp(-2 * decay * t);
  const Real r = Real{noise_rms} * noise_rms;
  const Real f = Real{force_rms} * force_rms;
  const Real c2 = r * d0;
  const Real c1 = r * d1 * (1 + d0) + f * n1 * n0;
  const Real c0 = r * (1 + d1 * d1 + d0 * d0) + f * (n1 * n1 + n0 * n0);
  const Complex root = std::sqrt(Complex(c1 * c1 - 4 * c2 * (c0 - 2 * c2)));
  const Complex e0 = inside((-c1 + root) / (2 * c2)) * inside((-c1 - root) / (2 * c2));
  const Real innovation = c2 / e0.real();
  return static_cast<double>(r * (innovation - r) / innovation);
}

ObserverTask one_mode(double frequency_hz, double damping) {
  ObserverTask task;
  task.frequency_hz = Eigen::VectorXd::Constant(1, frequency_hz);
  task.damping_ratio = Eigen::VectorXd::Constant(1, damping);
  task.region = Eigen::MatrixXd::Constant(1, 1, 0.49);  // a shape of 0.7
  task.fixed = {{Eigen::RowVectorXd::Constant(1, 1.3), {.name = "force", .rms = 0.2}}};
  task.sensor_rms = 2e-9;
  task.sample_time_s = 2e-4;
  return task;
}

TEST(ObserverModel, OfOneModeAndOneSensorHasAClosedForm) {
  for (const double frequency : {30.0, 400.0, 2100.0}) {
    for (const double damping : {0.001, 0.02, 0.6}) {
      for (const double noise : {1e-10, 1e-8, 1e-5}) {
        auto task = one_mode(frequency, damping);
        task.sensor_rms = noise;
        const double shape = 1.7;
        const double expected = 0.49 * variance_of_one_mode(frequency, damping, task.sample_time_s,
                                                            1.3 * 0.2, task.sensor_rms / shape);
        const auto value = ObserverModel(task).value(Eigen::MatrixXd::Constant(1, 1, shape), {});
        EXPECT_NEAR(value.estimate, expected, 1e-7 * expected)
            << frequency << " Hz, damping " << damping << ", noise " << noise;
      }
    }
  }
}

// ẍ + 2ζω ẋ + ω² x = w in continuous time: the poles s² + k₁ s + k₀ of the filter have k₀² = ω⁴ +
// w/v and k₁² = (2ζω)² + 2 (k₀ − ω²); the variance of x is v (k₁ − 2ζω).
TEST(ObserverModel, TendsToTheContinuousFilterAtHighRates) {
  auto task = one_mode(50.0, 0.01);
  const double density = 1e-4;  // two-sided [N²/Hz]
  const double v = 1e-18;       // [m²/Hz]
  const double w = kTwoPi * 50.0;
  const double k0 = std::sqrt(std::pow(w, 4) + 1.69 * density / v);
  const double k1 = std::sqrt(std::pow(0.02 * w, 2) + 2.0 * (k0 - w * w));
  const double expected = 0.49 * v * (k1 - 0.02 * w);
  double before = 1.0;
  for (const double t : {1e-5, 2.5e-6, 6.25e-7}) {
    task.sample_time_s = t;
    task.fixed[0].course.rms = std::sqrt(density / t);
    task.sensor_rms = std::sqrt(v / t);
    const auto value = ObserverModel(task).value(Eigen::MatrixXd::Ones(1, 1), {});
    const double off = std::abs(value.estimate / expected - 1.0);
    EXPECT_LT(off, 0.4 * before) << t;
    before = off;
  }
  EXPECT_LT(before, 0.02);
}

// The same beam as one model with its true inputs, and the filter of modal/kalman_filter.h.
modal::KalmanFilter filter_of(const ObserverTask& task, const Eigen::MatrixXd& sensors,
                              const Eigen::MatrixXd& actuators, const Eigen::MatrixXd& places) {
  modal::ReducedModel model;
  model.frequency_hz = task.frequency_hz;
  model.damping_ratio = task.damping_ratio;
  const auto r = task.frequency_hz.size();
  model.output_shapes.resize(sensors.rows() + places.rows(), r);
  model.output_shapes << sensors, places;
  std::vector<modal::Disturbance> disturbances;
  std::vector<Eigen::RowVectorXd> shapes;
  const auto add = [&](const Eigen::RowVectorXd& shape, modal::Disturbance course) {
    course.input = std::ssize(shapes);
    disturbances.push_back(course);
    shapes.push_back(shape);
  };
  for (const auto& one : task.fixed) add(one.shape, one.course);
  for (Eigen::Index j = 0; j < actuators.rows(); ++j) {
    for (const auto& course : task.at_actuators) add(actuators.row(j), course);
  }
  model.input_shapes.resize(r, std::ssize(shapes));
  std::vector<std::string> inputs;
  for (std::size_t j = 0; j < shapes.size(); ++j) {
    model.input_shapes.col(static_cast<Eigen::Index>(j)) = shapes[j].transpose();
    inputs.push_back("f" + std::to_string(j));
  }
  model.residual = Eigen::MatrixXd::Zero(model.output_shapes.rows(), std::ssize(shapes));
  model.dampers = {Eigen::MatrixXd(0, r), Eigen::MatrixXd(model.output_shapes.rows(), 0),
                   Eigen::MatrixXd(0, std::ssize(shapes)), Eigen::MatrixXd(0, 0)};
  std::vector<modal::OutputChannel> outputs;
  for (Eigen::Index i = 0; i < model.output_shapes.rows(); ++i) {
    outputs.push_back({"y" + std::to_string(i)});
  }
  return modal::kalman_filter(modal::disturbed_model(
      modal::control_model(model, outputs, inputs), 0, disturbances,
      Eigen::VectorXd::Constant(sensors.rows(), task.sensor_rms), task.sample_time_s));
}

ObserverTask beam_task(const Eigen::MatrixXd& region) {
  auto task = task_on(region);
  task.at_actuators.push_back({.name = "hum",
                               .course = modal::DisturbanceCourse::band,
                               .rms = 0.03,
                               .low_hz = 20.0,
                               .high_hz = 300.0});
  return task;
}

TEST(ObserverModel, KnowsWhatTheKalmanFilterOfTheWholeModelKnows) {
  const auto places = at({0.2, 0.7, 1.1, 1.6});
  const auto sensors = at({0.35, 0.9, 1.7});
  const auto actuators = at({0.5, 1.3});
  const auto task = beam_task(places);
  const auto filter = filter_of(task, sensors, actuators, places);
  const auto value = ObserverModel(task).value(sensors, actuators);
  const Eigen::VectorXd variance = filter.point_covariance.diagonal();
  EXPECT_NEAR(value.estimate, variance.mean(), 1e-8 * variance.mean());
  const double before = filter.prediction_covariance.diagonal().mean();
  EXPECT_NEAR(value.prediction, before, 1e-8 * before);
  const Eigen::VectorXd deviation = estimate_deviation(value.coordinates, places);
  EXPECT_LT((deviation - variance.cwiseSqrt()).norm(), 1e-8 * deviation.norm());
  EXPECT_GT(value.without, 10.0 * value.estimate);
}

// The beam by closed forms of its modes, with forces, noise and places of its own.
TEST(ObserverModel, ForetellsTheErrorOfALongSimulation) {
  const auto places = at({0.2, 0.7, 1.1, 1.6});
  const auto sensors = at({0.35, 0.9});
  const auto actuators = at({0.5, 1.3});
  const auto task = task_on(places);
  const auto filter = filter_of(task, sensors, actuators, places);
  constexpr int kBatches = 20;
  constexpr int kSamples = 6000;  // of 0.3 s; the slowest mode forgets in 0.32 s
  Draw draw(11);
  std::vector<Oscillator> modes;
  for (Eigen::Index k = 0; k < kModes; ++k) {
    modes.emplace_back(task.frequency_hz(k), task.damping_ratio(k), task.sample_time_s);
  }
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2, kModes);
  const int all = (kBatches + 2) * kSamples;
  Eigen::MatrixXd seen(all, sensors.rows());
  Eigen::MatrixXd moved(all, places.rows());
  for (int k = 0; k < all; ++k) {
    const Eigen::VectorXd q = state.row(0).transpose();
    for (Eigen::Index i = 0; i < sensors.rows(); ++i) {
      seen(k, i) = sensors.row(i).dot(q) + task.sensor_rms * draw.normal();
    }
    moved.row(k) = (places * q).transpose();
    Eigen::RowVectorXd force = 0.05 * draw.normal() * task.fixed[0].shape;
    for (Eigen::Index j = 0; j < actuators.rows(); ++j) {
      force += 0.02 * draw.normal() * actuators.row(j);
    }
    for (Eigen::Index m = 0; m < kModes; ++m) {
      const auto& mode = modes[static_cast<std::size_t>(m)];
      state.col(m) = (mode.a * state.col(m) + mode.b * force(m)).eval();
    }
  }
  const auto estimate = modal::estimate(filter, Eigen::MatrixXd(all, 0), seen);
  const Eigen::MatrixXd wrong = estimate.points - moved;
  Eigen::VectorXd square(kBatches);
  for (int b = 0; b < kBatches; ++b) {
    square(b) = wrong.middleRows((b + 2) * kSamples, kSamples).cwiseAbs2().mean();
  }
  const double spread =
      std::sqrt((square.array() - square.mean()).square().sum() / (kBatches - 1) / kBatches);
  const double expected = ObserverModel(task).value(sensors, actuators).estimate;
  EXPECT_NEAR(square.mean(), expected, 4.0 * spread);
  EXPECT_LT(spread, 0.05 * expected);  // else the test says nothing
}

TEST(ObserverModel, KnowsNoLessWithOneMoreSensorAndNoMoreWithMoreNoise) {
  Draw draw(5);
  for (int layout = 0; layout < 10; ++layout) {
    Eigen::VectorXd x(4);
    for (double& place : x) place = kLength * draw.uniform();
    const auto sensors = shapes_at(x);
    const auto actuators = at({0.5});
    auto task = task_on(at({0.4, 1.2, 1.9}));
    const ObserverModel model(task);
    double before = model.value({}, actuators).estimate;
    EXPECT_NEAR(before, model.value({}, actuators).without, 1e-12 * before);
    for (Eigen::Index count = 1; count <= 4; ++count) {
      const double now = model.value(sensors.topRows(count), actuators).estimate;
      EXPECT_LE(now, before * (1.0 + 1e-7));
      before = now;
    }
    for (const double more : {1.5, 10.0, 1e3, 1e6}) {
      task.sensor_rms = 1e-8 * more;
      const double now = ObserverModel(task).value(sensors, actuators).estimate;
      EXPECT_GE(now, before * (1.0 - 1e-7));
      before = now;
    }
    EXPECT_LE(before, model.value({}, actuators).without * (1.0 + 1e-7));
  }
}

// The cost by the two Riccati equations, and the motion and forces of the closed loop by
// Lyapunov's.
TEST(ObserverModel, LoopCostIsItsMotionAndItsForces) {
  auto task = beam_task(at({0.4, 1.2, 1.9}));
  for (const double effort : {1e-9, 1e-7, 1e-5, 1e-3}) {
    task.effort = effort;
    const ObserverModel model(task);
    double blind = 0.0;
    for (const auto& sensors : {Eigen::MatrixXd(0, kModes), at({0.35, 0.9, 1.7})}) {
      const auto value = model.value(sensors, at({0.5, 1.3}));
      EXPECT_NEAR(value.loop, value.loop_motion + effort * effort * value.loop_force_n2,
                  1e-6 * value.loop)
          << effort;
      EXPECT_LE(value.loop, value.without * (1.0 + 1e-7));
      EXPECT_GE(value.loop, blind);  // the states are known without sensors, by what is defined
      blind = value.loop;
    }
  }
}

TEST(ObserverModel, DoesNotDependOnSignsOrOnTheBasisOfRepeatedModes) {
  auto task = task_on(at({0.4, 1.2, 1.9}));
  task.frequency_hz(2) = task.frequency_hz(1) * 1.004;  // one group by its tolerance
  auto sensors = at({0.35, 0.9});
  auto actuators = at({0.5});
  task.effort = 1e-6;
  const auto before = ObserverModel(task).value(sensors, actuators);
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(kModes, kModes);
  turn(0, 0) = -1.0;
  turn.block<2, 2>(1, 1) = Eigen::Rotation2Dd(0.6).toRotationMatrix();
  task.region = (turn.transpose() * task.region * turn).eval();
  task.fixed[0].shape = (task.fixed[0].shape * turn).eval();
  const auto after = ObserverModel(task).value(sensors * turn, actuators * turn);
  EXPECT_NEAR(after.estimate, before.estimate, 1e-7 * before.estimate);
  EXPECT_NEAR(after.loop, before.loop, 1e-7 * before.loop);
}

TEST(ObserverModel, SeesAsMuchInAMirror) {
  auto task = task_on(at({0.4, 1.2}));
  const double one = ObserverModel(task).value(at({0.35, 0.9}), at({0.5})).estimate;
  auto mirrored = task_on(at({1.6, 0.8}));
  mirrored.fixed[0].shape = at({1.7}).row(0);
  const double other = ObserverModel(mirrored).value(at({1.65, 1.1}), at({1.5})).estimate;
  EXPECT_NEAR(one, other, 1e-7 * one);
}

// A free beam: its two rigid-body motions have no stiffness of their own.
TEST(ObserverModel, HoldsRigidBodyModesByASuspensionThatSensorsMakeUnimportant) {
  auto task = task_on(at({0.4, 1.2, 1.9}));
  task.rigid_count = 2;
  task.frequency_hz.head(2).setZero();
  task.damping_ratio.head(2).setZero();
  const auto sensors = at({0.35, 0.9, 1.7});
  const auto actuators = at({0.5});
  task.suspension_hz = 1.0;
  const auto firm = ObserverModel(task).value(sensors, actuators);
  task.suspension_hz = 0.25;
  const auto soft = ObserverModel(task).value(sensors, actuators);
  EXPECT_NEAR(soft.estimate, firm.estimate, 0.01 * firm.estimate);
  EXPECT_GT(soft.without, 2.0 * firm.without);  // without them it decides
}

// A drift has no variance of its own; its memory of a hundred times does not matter to the filter.
TEST(ObserverModel, TakesADrift) {
  auto task = task_on(at({0.4, 1.2, 1.9}));
  task.fixed[0].course = {
      .name = "hose", .course = modal::DisturbanceCourse::drift, .rms = 0.1, .drift_time_s = 0.5};
  const auto places = at({0.4, 1.2, 1.9});
  const auto sensors = at({0.35, 0.9});
  const auto actuators = at({0.5});
  const auto value = ObserverModel(task).value(sensors, actuators);
  const double exact =
      filter_of(task, sensors, actuators, places).point_covariance.diagonal().mean();
  EXPECT_NEAR(value.estimate, exact, 0.01 * exact);
}

TEST(ObserverModelRefuses, WhatSaysNothing) {
  const auto refused = [](const ObserverTask& task, const std::string& part) {
    const auto message = refusal_of([&] { return ObserverModel(task).mode_count(); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  const auto sound = task_on(at({0.4}));
  auto task = sound;
  task.fixed.clear();
  task.at_actuators.clear();
  refused(task, "no disturbance is stated");
  task = sound;
  task.sensor_rms = 0.0;
  refused(task, "the noise of the sensors is 0 m");
  task = sound;
  task.region.setZero();
  refused(task, "no mode moves the region");
  task = sound;
  task.damping_ratio(3) = 0.0;
  refused(task, "a mode has no damping");
  task = sound;
  task.region.conservativeResize(5, 5);
  refused(task, "do not fit");
  task = sound;
  task.fixed[0].shape.conservativeResize(3);
  refused(task, "disturbance \"hose\" does not fit");
  task = sound;
  task.rigid_count = 1;
  task.frequency_hz(0) = 0.0;
  task.suspension_hz = 300.0;
  refused(task, "held at 300 Hz; expected a frequency above 0 and below the first flexible mode");
  task = sound;
  task.sample_time_s = 0.0;
  refused(task, "sample time");
}

}  // namespace
}  // namespace chladni::placement
