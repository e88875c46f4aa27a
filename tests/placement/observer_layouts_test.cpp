// Layouts for an observer: against all layouts there are, and against other criteria.
#include "placement/observer_layouts.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/draw.h"
#include "placement/best_layouts.h"
#include "tests/placement/pinned_beam.h"
#include "tests/placement/plate.h"
#include "tests/refusal.h"

namespace chladni::placement {
namespace {

using namespace pinned_beam;
using enum DeviceKind;

ObserverProblem beam_problem(Eigen::Index candidates, DeviceCounts counts) {
  const auto sites = points_of_beam(candidates + 2);
  ObserverProblem problem;
  problem.task = task_on(shapes_at(Eigen::VectorXd::LinSpaced(9, 0.9, 1.7)));
  problem.task.effort = 1e-6;
  problem.rows = sites.shapes.middleRows(1, candidates);  // the ends do not move
  problem.sensors = Eigen::MatrixXd(0, kModes);
  problem.actuators = Eigen::MatrixXd(0, kModes);
  if (counts.only_sensors()) problem.actuators = shapes_at(Eigen::VectorXd::Constant(1, 0.5));
  problem.counts = counts;
  problem.position = sites.position.middleRows(1, candidates);
  return problem;
}

double cost_of(const ObserverProblem& problem, const std::vector<PlacedDevice>& devices) {
  return cost_of(problem, observer_value(problem, devices));
}

// The least cost of all layouts: `kinds` at different places, equal kinds by ascending place.
double least_cost(const ObserverProblem& problem, const std::vector<DeviceKind>& kinds) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<PlacedDevice> devices;
  const std::function<void()> extend = [&] {
    const auto k = devices.size();
    if (k == kinds.size()) {
      least = std::min(least, cost_of(problem, devices));
      return;
    }
    for (Eigen::Index site = 0; site < problem.rows.rows(); ++site) {
      const bool taken = std::ranges::any_of(devices, [&](auto& d) { return d.site == site; });
      const bool again = k > 0 && kinds[k - 1] == kinds[k] && site < devices[k - 1].site;
      if (taken || again) continue;
      devices.push_back({kinds[k], site});
      extend();
      devices.pop_back();
    }
  };
  extend();
  return least;
}

void expect_no_swap_gains(const ObserverProblem& problem, const ObserverChoice& choice) {
  const double cost = cost_of(problem, choice.value);
  EXPECT_TRUE(choice.swap_optimal);
  for (std::size_t k = 0; k < choice.devices.size(); ++k) {
    for (Eigen::Index site = 0; site < problem.rows.rows(); ++site) {
      auto other = choice.devices;
      if (std::ranges::any_of(other, [&](auto& d) { return d.site == site; })) continue;
      other[k].site = site;
      EXPECT_GE(cost_of(problem, other), cost * (1.0 - 1e-6)) << k << " to " << site;
    }
  }
}

TEST(BestObserver, IsSwapOptimalAndNearTheBestOfAllLayouts) {
  struct Case {
    DeviceCounts counts;
    std::vector<DeviceKind> kinds;
  };
  for (const auto& [counts, kinds] :
       {Case{{3, 0, 0}, {sensor, sensor, sensor}}, Case{{0, 0, 2}, {pair, pair}},
        Case{{1, 1, 0}, {actuator, sensor}}, Case{{1, 0, 1}, {pair, sensor}}}) {
    const auto problem = beam_problem(9, counts);
    const auto choice = best_observer(problem);
    ASSERT_EQ(choice.devices.size(), kinds.size());
    for (std::size_t k = 0; k < kinds.size(); ++k) EXPECT_EQ(choice.devices[k].kind, kinds[k]);
    expect_no_swap_gains(problem, choice);
    EXPECT_LE(cost_of(problem, choice.value), 1.02 * least_cost(problem, kinds))
        << counts.sensors << " " << counts.actuators << " " << counts.pairs;
  }
}

TEST(BestObserver, IsTheSameEachTimeAndBesideWhatIsThere) {
  auto problem = beam_problem(31, {.sensors = 2});
  problem.sensors = shapes_at(Eigen::VectorXd::Constant(1, 1.25));
  const auto once = best_observer(problem, {.seed = 3});
  const auto again = best_observer(problem, {.seed = 3});
  ASSERT_EQ(once.devices.size(), again.devices.size());
  for (std::size_t k = 0; k < once.devices.size(); ++k) {
    EXPECT_EQ(once.devices[k].site, again.devices[k].site);
  }
  EXPECT_EQ(once.value.estimate, again.value.estimate);
  EXPECT_EQ(once.layouts, again.layouts);
  expect_no_swap_gains(problem, once);
  auto alone = problem;
  alone.sensors.resize(0, kModes);
  EXPECT_LT(once.value.estimate, best_observer(alone).value.estimate);
}

TEST(BestObserver, KeepsTheSpacing) {
  auto problem = beam_problem(41, {.sensors = 3});
  problem.spacing = 0.5;
  const auto choice = best_observer(problem);
  for (const auto& one : choice.devices) {
    for (const auto& other : choice.devices) {
      if (one.site == other.site) continue;
      EXPECT_GE((problem.position.row(one.site) - problem.position.row(other.site)).norm(),
                0.5 - 1e-9);
    }
  }
  problem.spacing = 1.1;
  EXPECT_NE(refusal_of([&] { return best_observer(problem); }).find("3 devices at least 1100 mm"),
            std::string::npos);
}

// The candidates of a long list are tried in part; the layout is near that of all.
TEST(BestObserver, OfManyCandidatesIsAsGoodAsThatOfFewer) {
  const auto many = best_observer(beam_problem(599, {.sensors = 2}), {.starts = 1});
  const auto few = best_observer(beam_problem(59, {.sensors = 2}));
  EXPECT_FALSE(many.swap_optimal);
  EXPECT_LE(many.value.estimate, few.value.estimate * 1.001);
}

TEST(BestObserverRefuses, WhatCannotBeChosen) {
  const auto refused = [](const ObserverProblem& problem, const std::string& part) {
    const auto message = refusal_of([&] { return best_observer(problem); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  refused(beam_problem(5, {.sensors = 6}), "6 devices are wanted of 5 candidates");
  auto nowhere = beam_problem(5, {.sensors = 2});
  nowhere.position = nowhere.position.topRows(3).eval();
  refused(nowhere, "5 candidates and 3 positions");
  nowhere.position.resize(0, 3);
  EXPECT_EQ(best_observer(nowhere).devices.size(), 2U);
  nowhere.spacing = 0.1;
  refused(nowhere, "5 candidates and 0 positions");
  nowhere = beam_problem(481, {.sensors = 2});
  nowhere.position.resize(0, 3);
  refused(nowhere, "481 candidates without positions");
  refused(beam_problem(5, {}), "no device is to be chosen");
  auto problem = beam_problem(5, {.pairs = 1});
  problem.task.effort = 0.0;
  refused(problem, "what a force costs is not stated");
  problem = beam_problem(5, {.sensors = 1});
  problem.actuators.resize(0, kModes);
  problem.task.fixed.clear();
  refused(problem, "act at actuators alone, and there is no actuator");
  problem = beam_problem(5, {.sensors = 1});
  problem.rows(2, 1) = NAN;
  refused(problem, "not finite");
}

// The rms over places of what a filter on some sensors does not know, in a seeded simulation.
double simulated_rms(const ObserverTask& task, const Eigen::MatrixXd& sensors,
                     const Eigen::MatrixXd& actuators, const Eigen::MatrixXd& places,
                     unsigned seed) {
  const ObserverModel model(task);
  const auto system = model.disturbed(actuators);
  const auto n = system.a.rows();
  const Eigen::MatrixXd c = model.seen(sensors, n);
  const Eigen::MatrixXd z = model.seen(places, n) * task.sensor_rms;
  // The filter's gain by its own recursion, far beyond its settling.
  Eigen::MatrixXd p = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd gain;
  for (int k = 0; k < 20000; ++k) {
    const Eigen::MatrixXd seen = c * p;
    Eigen::MatrixXd innovation = seen * c.transpose();
    innovation.diagonal().array() += 1.0;
    gain = innovation.llt().solve(seen).transpose();
    p = system.a * (p - gain * seen) * system.a.transpose() + system.q();
    p = (0.5 * (p + p.transpose())).eval();
  }
  Draw draw(seed);
  const auto noise = [&](Eigen::Index count) {
    Eigen::VectorXd values(count);
    for (double& value : values) value = draw.normal();
    return values;
  };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd known = x;
  double square = 0.0;
  constexpr int kSettle = 8000;
  constexpr int kSamples = 60000;
  for (int k = 0; k < kSettle + kSamples; ++k) {
    const Eigen::VectorXd y = c * x + noise(c.rows());
    known += gain * (y - c * known);
    if (k >= kSettle) square += (z * (x - known)).squaredNorm() / static_cast<double>(z.rows());
    x = (system.a * x + system.noise * noise(system.noise.cols())).eval();
    known = (system.a * known).eval();
  }
  return std::sqrt(square / kSamples);
}

const Optimum& by(const std::vector<Optimum>& optima, const std::string& name) {
  return *std::ranges::find(optima, name, &Optimum::by);
}

// Layouts of `count` sensors by each criterion; what a simulation says of them.
void expect_least_simulated_error(const Structure& structure, const Sites& sites, Plan plan,
                                  const Eigen::MatrixXd& places, double least_gain) {
  std::vector<std::string> notes;
  const auto wanted = wanted_modes(structure, sites, plan, notes);
  plan.by_observer = true;
  const auto optima = best_layouts(structure, sites, {sites, true}, wanted, plan, 1);
  ASSERT_EQ(optima.size(), 3U);
  EXPECT_EQ(optima[0].by, "observer_error");
  const auto& actuators = structure.actuators.shapes;
  const auto rms = [&](const std::string& name) {
    return simulated_rms(*plan.observer, by(optima, name).shapes, actuators, places, 7);
  };
  const double own = rms("observer_error");
  EXPECT_NEAR(own, std::sqrt(optima[0].observer->estimate), 0.1 * own);
  for (const auto* other : {"determinant", "interpolation_error"}) {
    const double theirs = rms(other);
    testing::Test::RecordProperty(std::string(other) + "_over_observer",
                                  std::to_string(theirs / own));
    std::printf("%s: %.4g nm by %s, %.4g nm by the observer\n",
                testing::UnitTest::GetInstance()->current_test_info()->name(), 1e9 * theirs, other,
                1e9 * own);
    EXPECT_GT(theirs, least_gain * own) << other;
  }
}

TEST(BestObserver, KnowsTheBeamBetterThanLayoutsByOtherCriteria) {
  const Eigen::VectorXd actuators = Eigen::Vector2d(0.5, 1.5);
  const auto structure = beam({}, actuators);
  const auto places = shapes_at(Eigen::VectorXd::LinSpaced(9, 0.9, 1.7));
  Plan plan;
  plan.modes = {1, 2, 3};
  plan.sites = 3;
  plan.observer = task_on(places);
  expect_least_simulated_error(structure, points_of_beam(61), plan, places, 1.0);
}

TEST(BestObserver, KnowsThePlateBetterThanLayoutsByOtherCriteria) {
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  std::vector<mesh::Site> grid, feet;
  for (int i = 0; i < 49; ++i) {
    grid.push_back(*sampler.finder().from_above(0.09 * (i % 7 - 3), 0.09 * (i / 7 - 3)));
  }
  for (int i = 0; i < 4; ++i) {
    feet.push_back(*sampler.finder().from_above(i % 2 == 0 ? 0.18 : -0.18, i < 2 ? 0.18 : -0.18));
  }
  const auto sites = sampler.at(grid);
  const auto acting = sampler.at(feet);
  Structure structure;
  structure.frequency_hz = plate.modes.frequency_hz;
  structure.damping_ratio = Eigen::VectorXd::Constant(structure.frequency_hz.size(), 0.005);
  structure.rigid_count = 6;
  structure.mass_kg = 19.44;
  structure.size = 0.85;
  structure.sensors = {
      {Points(0, 3), Points(0, 3)}, Eigen::MatrixXd(0, structure.frequency_hz.size()), {}};
  structure.actuators.lines = {acting.position, Eigen::RowVector3d(0, 0, 1).replicate(4, 1)};
  structure.actuators.shapes = acting.shapes;
  std::vector<mesh::Site> exposed;
  for (int i = 0; i < 9; ++i) {
    exposed.push_back(*sampler.finder().from_above(0.03 * (i % 3), -0.03 * (i / 3)));
  }
  const Eigen::MatrixXd places = sampler.at(exposed).shapes;
  Plan plan;
  plan.modes = {1, 2, 3};
  plan.sites = 4;
  auto& task = plan.observer.emplace();
  task.frequency_hz = structure.frequency_hz;
  task.damping_ratio = structure.damping_ratio;
  task.rigid_count = 6;
  task.suspension_hz = 5.0;
  task.region = mean_square(places);
  task.at_actuators = {{.name = "amplifier", .rms = 0.02}};
  task.sensor_rms = 0.5e-9;
  task.sample_time_s = 1e-4;
  expect_least_simulated_error(structure, sites, plan, places, 1.0);
}

}  // namespace
}  // namespace chladni::placement
