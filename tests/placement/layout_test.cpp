#include "placement/layout.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "modal/frf.h"
#include "placement/constants.h"
#include "placement/wanted_modes.h"
#include "tests/placement/plate.h"

namespace chladni::placement {
namespace {

const std::vector<Eigen::Index> kWanted{6, 7, 8, 9, 10};  // the last two are a pair

LayoutView view_at(const std::vector<Eigen::Vector2d>& sensors,
                   const std::vector<Eigen::Vector2d>& actuators) {
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  const auto surface = sampler.surface({"top"});
  const auto seen = [&](const std::vector<Eigen::Vector2d>& at) {
    std::vector<mesh::Site> places;
    for (const auto& p : at) places.push_back(*sampler.finder().from_above(p.x(), p.y()));
    return sampler.at(places);
  };
  const auto s = seen(sensors), a = seen(actuators);
  LayoutView view;
  view.frequency_hz = plate.modes.frequency_hz(kWanted);
  view.damping_ratio = Eigen::VectorXd::Constant(5, 0.005);
  view.groups = modal::groups(view.frequency_hz, 0.01);
  view.sensors_all = s.shapes;
  view.actuators_all = a.shapes;
  view.sensors = s.shapes(Eigen::all, kWanted);
  view.actuators = a.shapes(Eigen::all, kWanted);
  const auto norms =
      group_norms(surface.sites.shapes(Eigen::all, kWanted), surface.sites.area, view.groups);
  view.rms.resize(5);
  view.rms << norms.rms(0), norms.rms(1), norms.rms(2), norms.rms(3), norms.rms(3);
  view.sensor_noise = 0.01 * view.rms;
  view.actuator_noise = 0.02 * view.rms;
  view.prior =
      shape_prior(surface.sites.shapes, surface.sites.area, plate.modes.frequency_hz, kWanted);
  view.surface_all = surface.sites.shapes;
  view.interest_all = seen({{0.05, 0.02}}).shapes;
  view.interest = view.interest_all(Eigen::all, kWanted);
  const Points up = Eigen::RowVector3d(0, 0, 1).replicate(20, 1);
  view.pairs = collocated({s.position, up.topRows(s.count())}, {a.position, up.topRows(a.count())},
                          1e-3, 1e-3);
  return view;
}

// What an observer on these sensors, under noise of these actuators, knows of the surface.
void observe(LayoutView& view) {
  if (view.sensors_all.rows() == 0) return;
  ObserverTask task;
  task.frequency_hz = square_plate().modes.frequency_hz;
  task.damping_ratio = Eigen::VectorXd::Constant(task.frequency_hz.size(), 0.005);
  task.rigid_count = 6;
  task.region = view.surface_all.transpose() * view.surface_all /
                static_cast<double>(view.surface_all.rows());
  task.at_actuators = {{.name = "amplifier", .rms = 0.02}};
  task.sensor_rms = 1e-9;
  task.sample_time_s = 1e-4;
  task.effort = 1e-7;
  view.observer = ObserverModel(task).value(view.sensors_all, view.actuators_all);
}

LayoutView some_view() {
  auto view = view_at({{0.25, 0.1}, {-0.2, 0.25}, {-0.25, -0.15}, {0.1, -0.27}},
                      {{0.25, 0.1}, {0.0, 0.1}, {0.15, 0.2}, {-0.1, -0.05}, {0.2, -0.2}});
  observe(view);
  return view;
}

class EveryLayoutCriterion : public ::testing::TestWithParam<const LayoutCriterion*> {};

TEST_P(EveryLayoutCriterion, IsFiniteForAnOrdinaryLayout) {
  EXPECT_TRUE(std::isfinite(GetParam()->value(some_view())));
}

TEST_P(EveryLayoutCriterion, IsBlindToSignsAndToARotationOfAPair) {
  auto view = some_view();
  const double before = GetParam()->value(view);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.6).toRotationMatrix();
  for (auto* shapes : {&view.sensors, &view.actuators, &view.interest}) {
    shapes->col(1) *= -1.0;
    shapes->rightCols(2) *= turn;
  }
  for (auto* shapes :
       {&view.sensors_all, &view.actuators_all, &view.surface_all, &view.interest_all}) {
    shapes->col(7) *= -1.0;
    shapes->middleCols(9, 2) *= turn;
  }
  Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(view.prior.gram.rows(), view.prior.gram.rows());
  whole(7, 7) = -1.0;
  whole.block<2, 2>(9, 9) = turn;
  view.prior.gram = (whole.transpose() * view.prior.gram * whole).eval();
  observe(view);
  EXPECT_NEAR(GetParam()->value(view), before, 2e-4 * std::abs(before) + 1e-12);
}

TEST_P(EveryLayoutCriterion, SaysThatItDoesNotApplyToAnEmptyLayout) {
  const double value = GetParam()->value(view_at({}, {}));
  EXPECT_TRUE(std::isnan(value) || value == 0.0) << value;
}

INSTANTIATE_TEST_SUITE_P(LayoutCriteria, EveryLayoutCriterion,
                         ::testing::ValuesIn(layout_criteria().begin(), layout_criteria().end()),
                         [](const auto& one) { return std::string(one.param->name); });

// The criterion `response` of separate modes is half of the largest receptance that each has by
// itself, over all channels: ‖φ_s‖ ‖φ_a‖ / 2ζω² at its resonance.
TEST(Layout, ItsResponseIsHalfOfTheWeakestPeak) {
  auto view = some_view();
  view.groups = {{.first = 0, .size = 1}};
  modal::ReducedModel mode;
  mode.frequency_hz = view.frequency_hz.head(1);
  mode.damping_ratio = view.damping_ratio.head(1);
  mode.output_shapes = view.sensors.leftCols(1);
  mode.input_shapes = view.actuators.leftCols(1).transpose();
  mode.residual.setZero(view.sensors.rows(), view.actuators.rows());
  const auto peak = modal::frf(mode, mode.frequency_hz).value.front();
  const auto& all = layout_criteria();
  const auto response = std::ranges::find(all, std::string_view("response"),
                                          [](const auto* one) { return one->name; });
  ASSERT_NE(response, all.end());
  EXPECT_NEAR((*response)->value(view), 0.5 * peak.norm(), 1e-9 * peak.norm());
}

TEST(Layout, CountsPairsOnce) {
  const auto view = some_view();
  ASSERT_EQ(view.pairs.size(), 1U);
  EXPECT_EQ(observed(view).rows(), 4 + 5 - 1);  // (5.2)
  const auto all = samples(view);
  EXPECT_LT(all.noise(0, 0), 0.01);  // two samples of one place
  EXPECT_NEAR(all.noise(1, 0), 0.01, 1e-12);
  EXPECT_NEAR(all.noise(5, 0), 0.02, 1e-12);
}

TEST(Layout, OnMirrorLinesIsBlindToWhatIsOddAboutThem) {
  const auto on_lines = view_at({{0.2, 0.0}, {-0.1, 0.0}, {0.0, 0.25}, {0.0, -0.15}}, {});
  EXPECT_LT(sight(on_lines)(0), 1e-3);  // the first mode twists: zero on both axes
  EXPECT_LT(sight(on_lines)(0), Constants::blind);
  EXPECT_GT(sight(some_view()).minCoeff(), Constants::blind);
}

double value_of(std::string_view name, const LayoutView& view) {
  return (*std::ranges::find(layout_criteria(), name, [](const auto* one) { return one->name; }))
      ->value(view);
}

// Not what rounding leaves of zero.
TEST(Layout, OfPointsAtOnePlaceTellsNoModesApart) {
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(0.05, 0.03), Eigen::Vector2d(0.21, -0.13),
                                    Eigen::Vector2d(-0.28, 0.17), Eigen::Vector2d(0.1, 0.25)}) {
    const auto view = view_at(std::vector<Eigen::Vector2d>(6, at), {});
    EXPECT_EQ(value_of("smallest_singular_value", view), 0.0);
    for (const auto* name : {"determinant", "a_optimality", "condition"}) {
      EXPECT_FALSE(std::isfinite(value_of(name, view))) << name;
    }
  }
}

TEST(Layout, APointMoreTakesNoSightAway) {
  std::vector<Eigen::Vector2d> at{{0.2, 0.13}, {-0.1, 0.27}, {0.21, 0.25}, {0.07, -0.15}};
  Eigen::VectorXd before = sight(view_at(at, {}));
  for (int k = 0; k < 12; ++k) {
    at.emplace_back(0.0, 0.02 * k);  // on a mirror line, which half of the modes leave at rest
    const Eigen::VectorXd now = sight(view_at(at, {}));
    for (Eigen::Index g = 0; g < now.size(); ++g) EXPECT_GE(now(g), before(g) * (1.0 - 1e-9)) << k;
    before = now;
  }
}

TEST(ExpectedError, FallsWithEverySiteAndIsOneWithout) {
  const auto view = some_view();
  const Eigen::MatrixXd nothing(0, view.surface_all.cols());
  EXPECT_TRUE(expected_error(view.prior, nothing, Eigen::MatrixXd(0, 5)).per_mode.isOnes(1e-9));
  const auto all = samples(view);
  double before = 1.0;
  for (Eigen::Index k = 1; k <= all.rows.rows(); ++k) {
    const double error =
        expected_error(view.prior, all.rows.topRows(k), all.noise.topRows(k)).mean();
    EXPECT_LT(error, before);
    before = error;
  }
}

TEST(ExpectedError, IsTheMeanSquareOfTheDeviationOverTheSurface) {
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  const auto surface = sampler.surface({"top"});
  const auto view = some_view();
  const auto all = samples(view);
  const auto error = expected_error(view.prior, all.rows, all.noise);
  const Eigen::MatrixXd deviation =
      expected_deviation(view.prior, all.rows, all.noise, surface.sites.shapes);
  const Eigen::VectorXd mean =
      deviation.cwiseAbs2().transpose() * surface.sites.area / surface.sites.area.sum();
  EXPECT_TRUE(mean.isApprox(error.per_mode, 1e-9));
}

// Nine of 81 sites of the plate's top, with a sample's noise over the shape's root mean square.
InterpolationProblem grid_problem(double noise) {
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  std::vector<mesh::Site> grid;
  for (int i = 0; i < 81; ++i) {
    grid.push_back(*sampler.finder().from_above(0.06 * (i % 9 - 4), 0.06 * (i / 9 - 4)));
  }
  const auto sites = sampler.at(grid);
  InterpolationProblem problem;
  problem.rows = sites.shapes;
  problem.noise = Eigen::VectorXd::Constant(5, noise);
  problem.there.resize(0, sites.shapes.cols());
  problem.there_noise.resize(0, 5);
  problem.prior = some_view().prior;
  problem.count = 9;
  problem.position = sites.position;
  return problem;
}

double error_of(const InterpolationProblem& problem, const std::vector<Eigen::Index>& chosen) {
  const Eigen::MatrixXd noise =
      problem.noise.transpose().replicate(static_cast<Eigen::Index>(chosen.size()), 1);
  return expected_error(problem.prior, problem.rows(chosen, Eigen::all), noise).mean();
}

class BestInterpolation : public ::testing::TestWithParam<double> {};

// The score is that of the layout by itself, however many sites were exchanged on the way.
TEST_P(BestInterpolation, IsNoWorseThanAnySwapAndThanLayoutsByHand) {
  auto problem = grid_problem(GetParam());
  const auto best = best_interpolation(problem);
  EXPECT_NEAR(error_of(problem, best.sites), -best.score, 1e-9 * -best.score);
  for (std::size_t k = 0; k < 9; ++k) {
    for (Eigen::Index c = 0; c < 81; ++c) {
      auto other = best.sites;
      other[k] = c;
      if (std::count(best.sites.begin(), best.sites.end(), c) > 0) continue;
      EXPECT_GE(error_of(problem, other), -best.score * (1.0 - 1e-6));
    }
  }
  const auto by_hand = [&](const std::vector<Eigen::Index>& sites) {
    return error_of(problem, sites);
  };
  // The best here is an even grid of 3 by 3 that reaches the rim: by hand it ties but for rounding.
  EXPECT_LE(-best.score, by_hand({0, 4, 8, 36, 40, 44, 72, 76, 80}) * (1.0 + 1e-9));
  EXPECT_LT(-best.score, 0.9 * by_hand({20, 22, 24, 38, 40, 42, 56, 58, 60}));  // half as wide
  EXPECT_LT(-best.score, 0.9 * by_hand({0, 1, 2, 3, 4, 5, 6, 7, 8}));           // along one edge
  problem.count = 82;
  EXPECT_THROW((void)best_interpolation(problem), InvalidInput);
}

INSTANTIATE_TEST_SUITE_P(Noise, BestInterpolation, ::testing::Values(1e-2, 1e-4, 1e-6, 1e-9));

// With more sites than modes the error is that of weighted least squares, and falls with the square
// of the noise: the motion that the sites know must not drown the rest in its rounding.
TEST(ExpectedError, FallsWithTheSquareOfSmallNoise) {
  const auto problem = grid_problem(1e-3);
  const auto error = [&](double noise) {
    return expected_error(problem.prior, problem.rows, Eigen::MatrixXd::Constant(81, 5, noise))
        .mean();
  };
  EXPECT_NEAR(error(1e-6) / error(1e-7), 100.0, 1e-3);
  EXPECT_NEAR(error(1e-7) / error(1e-8), 100.0, 1e-3);
}

TEST(Collocated, TakesEachActuatorOnceAndTheNearest) {
  Points sensors(2, 3), actuators(3, 3);
  sensors << 0, 0, 0, 0.5, 0, 0;
  actuators << 0.0005, 0, 0, 0.0001, 0, 0, 0.7, 0, 0;
  const Points up = Eigen::RowVector3d(0, 0, 1).replicate(3, 1);
  const auto pairs = collocated({sensors, up.topRows(2)}, {actuators, up}, 1e-3, 1e-3);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0], std::pair(Eigen::Index{0}, Eigen::Index{1}));
}

// A sensor at the very place of an actuator is its partner, whatever stands first.
TEST(Collocated, DoNotDependOnTheOrderOfTheChannels) {
  std::mt19937 random(5);
  const auto lines = [&](Eigen::Index count) {
    Lines placed{Points::Zero(count, 3), Points::Zero(count, 3)};
    for (Eigen::Index i = 0; i < count; ++i) {
      placed.position(i, 0) =
          1e-3 * static_cast<double>(random() % 1000) + 1e-6 * static_cast<double>(i);
    }
    placed.direction.col(0).setOnes();
    return placed;
  };
  for (int k = 0; k < 100; ++k) {
    const auto sensors = lines(4);
    auto actuators = lines(5);
    actuators.position.row(2) = sensors.position.row(3);
    actuators.position.col(0).array() += 1e-7 * Eigen::ArrayXd::LinSpaced(5, 0.0, 4.0);  // no ties
    const auto pairs = collocated(sensors, actuators, 1e-3, 0.2);
    const auto has = [&](Eigen::Index s, Eigen::Index a) {
      return std::ranges::find(pairs, std::pair(s, a)) != pairs.end();
    };
    EXPECT_TRUE(has(3, 2)) << k;
    const Lines turned{sensors.position.colwise().reverse(), sensors.direction};
    auto again = collocated(turned, actuators, 1e-3, 0.2);
    for (auto& pair : again) pair.first = 3 - pair.first;
    std::ranges::sort(again);
    EXPECT_EQ(again, pairs) << k;
  }
}

// Devices 0.9 mm apart on a body of 6 mm are as far from each other as 90 mm on one of 600 mm.
TEST(Collocated, AreTheSameOnASmallBody) {
  const auto pairs = [](double scale) {
    Lines sensors{Points(2, 3), Points(2, 3)}, actuators = sensors;
    sensors.position << 0.0, 0.0, 0.0, 0.2, 0.1, 0.0;
    actuators.position << 0.09, 0.0, 0.0, 0.2, 0.1, -0.02;
    sensors.position *= scale;
    actuators.position *= scale;
    sensors.direction << 0.0, 0.0, 1.0, 0.0, 0.0, 1.0;
    actuators.direction = sensors.direction;
    return collocated_pairs(sensors, actuators, 0.6 * scale);
  };
  const std::vector<std::pair<Eigen::Index, Eigen::Index>> second{{1, 1}};
  EXPECT_EQ(pairs(1.0), second);
  EXPECT_EQ(pairs(0.01), second);
}

TEST(Collocated, AreOnBothFacesOfAThinBodyButNotBesideEachOther) {
  Points sensors(2, 3), actuators(2, 3);
  sensors << 0, 0, 0, 0.5, 0, 0;
  actuators << 0, 0, -0.02, 0.5, 0.01, 0;
  const Points up = Eigen::RowVector3d(0, 0, 1).replicate(2, 1);
  const Points down = -up;
  EXPECT_EQ(collocated({sensors, up}, {actuators, down}, 1e-3, 0.03).size(), 1U);
  EXPECT_TRUE(collocated({sensors, up}, {actuators, down}, 1e-3, 0.01).empty());
  const Points aside = Eigen::RowVector3d(1, 0, 0).replicate(2, 1);
  EXPECT_TRUE(collocated({sensors, up}, {actuators, aside}, 1e-3, 0.03).empty());
}

}  // namespace
}  // namespace chladni::placement
