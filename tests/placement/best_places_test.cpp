// Best pairs and layouts of a pinned beam from its closed-form modes, without a study or a mesh.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "placement/best_layouts.h"
#include "placement/best_pairs.h"
#include "tests/placement/pinned_beam.h"
#include "tests/refusal.h"

namespace chladni::placement {
namespace {

using namespace pinned_beam;
constexpr double kPi = std::numbers::pi;

PairPlaces pairs_of(const Structure& structure, const Sites& sites, const Plan& plan) {
  std::vector<std::string> notes;
  const auto wanted = wanted_modes(structure, sites, plan, notes);
  const PairViews views(structure, sites, wanted, plan);
  return best_pairs(views, sites, {sites, true}, plan, nullptr, {});
}

std::vector<Optimum> optima_of(const Structure& structure, const Sites& sites, const Plan& plan) {
  std::vector<std::string> notes;
  const auto wanted = wanted_modes(structure, sites, plan, notes);
  return best_layouts(structure, sites, {sites, true}, wanted, plan, 1);
}

// sin(a) = sin(2a) at a third of the span: no place sees the weaker of both modes better.
TEST(BestPlaces, APairForTwoModesSitsAtAThirdOfAPinnedBeam) {
  Plan plan;
  plan.modes = {1, 2};
  const auto places = pairs_of(beam(), points_of_beam(601), plan);
  ASSERT_GE(places.best.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const double x = places.best[i].position.x();
    EXPECT_NEAR(std::min(x, kLength - x), kLength / 3.0, 1e-9);
    EXPECT_NEAR(places.best[i].score, std::sin(kPi / 3.0), 1e-9);
  }
  plan.modes = {1};
  EXPECT_NEAR(pairs_of(beam(), points_of_beam(601), plan).best[0].position.x(), 0.5 * kLength,
              1e-9);
}

// det = 2 sin²a cos a of the sites at a and π - a is largest where tan²a = 2.
TEST(BestPlaces, TwoSitesTellTwoModesApartWhereTheDeterminantIsLargest) {
  Plan plan;
  plan.modes = {1, 2};
  plan.sites = 2;
  const Eigen::Index count = 201;
  const auto optimum = optima_of(beam(), points_of_beam(count), plan).front();
  EXPECT_EQ(optimum.by, "determinant");
  ASSERT_EQ(optimum.sites.rows(), 2);
  const double grid = kLength / static_cast<double>(count - 1);
  const double x = kLength * std::atan(std::numbers::sqrt2) / kPi;
  EXPECT_NEAR(optimum.sites.col(0).minCoeff(), x, grid);
  EXPECT_NEAR(optimum.sites.col(0).maxCoeff(), kLength - x, grid);
  EXPECT_GE(optimum.choice.bound, optimum.choice.score - 1e-9);
}

TEST(BestPlaces, TheOtherCriterionComesFirstWhereThePlanAsksForIt) {
  Plan plan;
  plan.by_interpolation = true;
  const auto optima = optima_of(beam(), points_of_beam(31), plan);
  ASSERT_EQ(optima.size(), 2U);
  EXPECT_EQ(optima[0].by, "interpolation_error");
  EXPECT_EQ(optima[1].by, "determinant");
  EXPECT_EQ(optima[0].sites.rows(), 4);  // one more than the three wanted modes
}

// A sensor in the middle stands on the node of every antisymmetric mode.
TEST(BestPlaces, ASensorInTheMiddleIsBlindForEvenModes) {
  const Eigen::VectorXd middle = Eigen::VectorXd::Constant(1, 0.5 * kLength);
  const auto structure = beam(middle, middle);
  const auto sites = points_of_beam(201);
  std::vector<std::string> notes;
  const Plan plan;
  const auto wanted = wanted_modes(structure, sites, plan, notes);
  const LayoutScorer scorer(structure, sites, wanted, plan);
  EXPECT_EQ(scorer.of_channels({0}, {}).blind, (std::vector<int>{2, 4, 6}));
  EXPECT_EQ(scorer.of_channels({0}, {}).pairs, 0);
  EXPECT_EQ(scorer.of_channels({0}, {0}).pairs, 1);
  EXPECT_TRUE(scorer.of_sensors(shapes_at(Eigen::VectorXd::Constant(1, 0.21))).blind.empty());
}

TEST(BestPlaces, DoNotDependOnTheSignsOfModes) {
  Plan plan;
  plan.modes = {1, 2, 3};
  const auto sites = points_of_beam(31);
  auto turned = sites;
  turned.shapes.col(1) *= -1.0;
  turned.shapes.col(2) *= -1.0;
  const auto one = optima_of(beam(), sites, plan);
  const auto other = optima_of(beam(), turned, plan);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_NEAR(one[i].choice.score, other[i].choice.score, 1e-9) << one[i].by;
  }
  EXPECT_NEAR(pairs_of(beam(), sites, plan).best[0].score,
              pairs_of(beam(), turned, plan).best[0].score, 1e-12);
}

TEST(BestPlacesRefuse, ModesAndSitesThatDoNotExist) {
  const auto refused = [](const Plan& plan, const std::string& part) {
    const auto message = refusal_of([&] { return optima_of(beam(), points_of_beam(11), plan); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  Plan plan;
  plan.modes = {7};
  refused(plan, "asks for flexible mode 7, but 6 were computed");
  plan.modes = {};
  plan.sites = 12;
  refused(plan, "12 sites are to be chosen, but 11 are admissible");
  plan.up_to_hz = 20.0;
  refused(plan, "the first flexible mode lies at 50 Hz");
}

TEST(BestPlacesRefuse, ArraysThatDoNotFit) {
  const auto sites = points_of_beam(11);
  const auto refused = [&](const Structure& structure, const std::string& part) {
    std::vector<std::string> notes;
    const auto message = refusal_of([&] { return wanted_modes(structure, sites, {}, notes); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  auto structure = beam();
  structure.frequency_hz.conservativeResize(5);
  refused(structure, "the number of modes on the surface is 6; expected 5");
  structure = beam(Eigen::VectorXd::Constant(2, 0.1));
  structure.sensors.lines.position.conservativeResize(1, Eigen::NoChange);
  refused(structure, "the number of places of sensors is 1; expected 2");
  structure = beam(Eigen::VectorXd::Constant(2, 0.1));
  structure.sensors.stays = {1};
  refused(structure, "not one mark for each of the sensors");
}

}  // namespace
}  // namespace chladni::placement
