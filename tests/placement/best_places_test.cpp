// Best pairs and layouts of a pinned beam from its closed-form modes, without a study or a mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string_view>

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

// A hundred sensors on a node line do not make the one beside them blind.
TEST(BestPlaces, SensorsThatSeeNothingOfAModeTakeNoSightFromOneThatDoes) {
  Eigen::VectorXd at = Eigen::VectorXd::Constant(121, 0.5 * kLength);
  at(7) = 0.21;
  const auto structure = beam(at);
  const auto sites = points_of_beam(201);
  std::vector<std::string> notes;
  const Plan plan;
  const LayoutScorer scorer(structure, sites, wanted_modes(structure, sites, plan, notes), plan);
  std::vector<std::size_t> all(121);
  std::iota(all.begin(), all.end(), std::size_t{0});
  EXPECT_TRUE(scorer.of_channels({7}, {}).blind.empty());
  EXPECT_TRUE(scorer.of_channels(all, {}).blind.empty());
}

double score_called(std::string_view name, const LayoutScore& layout) {
  const auto& all = layout_criteria();
  const auto found = std::ranges::find(all, name, [](const auto* one) { return one->name; });
  return layout.scores(found - all.begin());
}

// A sensor and an actuator that stay, at places that no site is near, and noise of FRFs, which is
// not the same for both.
struct WithThoseThatStay {
  WithThoseThatStay() {
    structure = beam(Eigen::Vector2d(0.31, 0.9), Eigen::Vector2d(1.43, 0.2));
    structure.sensors.stays = {1, 0};
    structure.actuators.stays = {1, 0};
    plan.modes = {1, 2, 3};
    plan.sites = 2;
    plan.frf_noise = 1e-9;
    plan.resolution_hz = 1.0;
    std::vector<std::string> notes;
    wanted = wanted_modes(structure, sites, plan, notes);
  }

  Structure structure;
  Sites sites = points_of_beam(31);
  Plan plan;
  WantedModes wanted;
};

// What chose a best layout is what it is scored by, with what stays.
TEST(BestPlaces, AreScoredWithTheChannelsThatStay) {
  const WithThoseThatStay on;
  ASSERT_GT(std::abs(on.wanted.sensor_noise(0) / on.wanted.actuator_noise(0) - 1.0), 0.1);
  const LayoutScorer scorer(on.structure, on.sites, on.wanted, on.plan);
  const auto optima = best_layouts(on.structure, on.sites, {on.sites, true}, on.wanted, on.plan, 1);
  const auto by_determinant = scorer.of_sensors(optima[0].shapes);
  EXPECT_NEAR(score_called("determinant", by_determinant), optima[0].choice.score, 1e-6);
  const auto by_interpolation = scorer.of_sensors(optima[1].shapes);
  EXPECT_NEAR(score_called("interpolation_error", by_interpolation), -optima[1].choice.score,
              1e-9 * -optima[1].choice.score);
  EXPECT_EQ(score_called("observed_points", by_interpolation), 4.0);
  EXPECT_TRUE(std::isfinite(score_called("controllability", by_interpolation)));
}

TEST(BestPlaces, ThatAreChosenNowhereAreThoseThatStay) {
  const WithThoseThatStay on;
  const LayoutScorer scorer(on.structure, on.sites, on.wanted, on.plan);
  const auto none = scorer.of_sensors(Eigen::MatrixXd(0, kModes));
  EXPECT_TRUE(none.scores.array()
                  .isNaN()
                  .select(0.0, none.scores)
                  .isApprox(scorer.of_channels({0}, {0}).scores.array().isNaN().select(
                      0.0, scorer.of_channels({0}, {0}).scores)));
}

// Modes 2 and 3 of one frequency have no shapes of their own, and no noise of their own.
TEST(WantedModes, NoiseOfFrfsIsBlindToARotationOfEqualModes) {
  Plan plan;
  plan.modes = {1, 2, 3};
  plan.frf_noise = 1e-9;
  plan.resolution_hz = 1.0;
  const auto wanted_after = [&](double angle, const Eigen::VectorXd& actuators) {
    auto structure = beam(Eigen::Vector3d(0.31, 0.9, 1.2), actuators);
    auto sites = points_of_beam(31);
    structure.frequency_hz(2) = structure.frequency_hz(1);
    Eigen::Matrix2d turn;
    turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    for (auto* shapes : {&structure.sensors.shapes, &structure.actuators.shapes, &sites.shapes}) {
      shapes->middleCols(1, 2) *= turn;
    }
    std::vector<std::string> notes;
    return wanted_modes(structure, sites, plan, notes);
  };
  for (const Eigen::VectorXd& actuators :
       {Eigen::VectorXd(Eigen::Vector2d(0.2, 1.43)), Eigen::VectorXd::Constant(1, 0.2).eval()}) {
    const auto before = wanted_after(0.0, actuators);
    for (const double angle : {0.4, 1.1, 2.6}) {
      const auto after = wanted_after(angle, actuators);
      EXPECT_TRUE(after.sensor_noise.isApprox(before.sensor_noise, 1e-9));
      EXPECT_TRUE(after.actuator_noise.isApprox(before.actuator_noise, 1e-9));
    }
  }
}

// Two actuators in one place drive one combination of two equal modes: the other stays unknown.
TEST(WantedModes, NoiseOfFrfsKnowsWhereTwoChannelsDriveOneOfTwoEqualModes) {
  auto structure = beam(Eigen::Vector2d(0.31, 0.9), Eigen::Vector2d(0.2, 0.2));
  structure.frequency_hz(2) = structure.frequency_hz(1);
  Plan plan;
  plan.modes = {1, 2, 3};
  plan.frf_noise = 1e-9;
  plan.resolution_hz = 1.0;
  std::vector<std::string> notes;
  const auto wanted = wanted_modes(structure, points_of_beam(31), plan, notes);
  EXPECT_GT(wanted.sensor_noise(1), 10.0 * wanted.rms(1));
  EXPECT_LT(wanted.sensor_noise(0), wanted.rms(0));
}

// What comes after the last mode is not known: it may be its partner.
TEST(WantedModes, SayThatTheGroupOfTheLastModeMayGoOn) {
  const auto structure = beam(Eigen::Vector2d(0.31, 0.9), Eigen::Vector2d(0.2, 0.2));
  for (const int mode : {static_cast<int>(kModes) - 1, static_cast<int>(kModes)}) {
    Plan plan;
    plan.modes = {mode};
    std::vector<std::string> notes;
    (void)wanted_modes(structure, points_of_beam(31), plan, notes);
    ASSERT_EQ(notes.size(), mode == kModes ? 1U : 0U);
    if (notes.empty()) continue;
    EXPECT_NE(notes[0].find("is the last that was computed"), std::string::npos) << notes[0];
  }
}

// Modes of the pinned beam with their slopes, d/dx √2 sin(kπx/L).
Sites points_with_slopes(Eigen::Index count) {
  auto sites = points_of_beam(count);
  for (Eigen::Index k = 0; k < kModes; ++k) {
    const double wave = static_cast<double>(k + 1) * kPi / kLength;
    sites.slopes.col(k) =
        std::numbers::sqrt2 * wave * (wave * sites.position.col(0).array()).cos().abs();
  }
  return sites;
}

// Var ln α = (σ_s² + σ_a² + 2 σ_p² |φ'|²) / 4φ² of one pair: a wrong place is as bad as noise.
TEST(BestPlaces, AlphaOfALayoutKnowsTheErrorOfThePosition) {
  const double x = 0.4 * kLength;
  const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, x);
  const auto structure = beam(at, at);
  const auto sites = points_with_slopes(201);  // one of them at x
  Plan plan;
  plan.modes = {1};
  plan.position_error = 0.02;
  std::vector<std::string> notes;
  const auto wanted = wanted_modes(structure, sites, plan, notes);
  const double shape = shapes_at(at)(0, 0);
  const double slope = std::numbers::sqrt2 * kPi / kLength * std::cos(kPi * x / kLength);
  const auto expected = [&](double error) {
    const double noise =
        std::pow(wanted.sensor_noise(0), 2) + std::pow(wanted.actuator_noise(0), 2);
    return 50.0 * std::sqrt(noise + 2.0 * error * error * slope * slope) / shape;
  };
  const auto score = LayoutScorer(structure, sites, wanted, plan).of_channels({0}, {0});
  EXPECT_NEAR(score_called("pair_alpha", score), expected(0.02), 1e-9);
  EXPECT_GT(expected(0.02), 1.5 * expected(0.0));
  auto own = structure;  // slopes of the channel itself go first
  own.sensors.slopes = Eigen::MatrixXd::Zero(1, kModes);
  const auto steady = LayoutScorer(own, sites, wanted, plan).of_channels({0}, {0});
  EXPECT_NEAR(score_called("pair_alpha", steady), expected(0.0), 1e-9);
}

// A pair that stays is no surer of its place than one that is chosen.
TEST(BestPlaces, APairThatStaysHasTheErrorOfItsPosition) {
  auto structure = beam(Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Constant(1, 0.3));
  structure.sensors.stays = structure.actuators.stays = {1};
  const auto sites = points_with_slopes(201);
  Plan plan;
  plan.modes = {1};
  plan.criterion = "alpha_uncertainty";
  plan.position_error = 0.02;
  std::vector<std::string> notes;
  const auto wanted = wanted_modes(structure, sites, plan, notes);
  const auto view = PairViews(structure, sites, wanted, plan).view(sites, 0);
  ASSERT_EQ(view.present.rows(), 1);
  EXPECT_NEAR(view.present_slopes(0, 0),
              std::numbers::sqrt2 * kPi / kLength * std::cos(0.3 * kPi / kLength), 1e-12);
}

// A pair is one point, whoever chose it.
TEST(BestPlaces, APairOfAnObserverIsOnePoint) {
  const WithThoseThatStay on;
  const LayoutScorer scorer(on.structure, on.sites, on.wanted, on.plan);
  Optimum optimum;
  optimum.shapes = shapes_at(Eigen::Vector3d(0.5, 0.8, 1.7));
  optimum.sites = lines_at(Eigen::Vector3d(0.5, 0.8, 1.7)).position;
  using enum DeviceKind;
  optimum.kinds = {pair, actuator, sensor};
  const auto score = scorer.of_devices(optimum);
  EXPECT_EQ(score.pairs, 1);
  EXPECT_EQ(score_called("observed_points", score), 5.0);
}

// Three sites tell three modes apart unless all lie where the second does not move.
TEST(BestPlaces, HaveNoCertificateWhereTheySeeNothingOfAMode) {
  Plan plan;
  plan.modes = {1, 2, 3};
  plan.sites = 3;
  auto sites = points_of_beam(31);
  EXPECT_GT(optima_of(beam(), sites, plan)[0].certificate, 0.9);
  sites.shapes.col(1) *= 1e-9;
  std::vector<std::string> notes;
  const auto wanted = wanted_modes(beam(), points_of_beam(31), plan, notes);
  const auto blind = best_layouts(beam(), points_of_beam(31), {sites, true}, wanted, plan, 1)[0];
  EXPECT_EQ(blind.certificate, 0.0);
  EXPECT_NE(blind.remark.find("3 sites cannot tell 3 modes apart"), std::string::npos);
}

// One site beside one sensor that stays is one too few for three modes.
TEST(BestPlaces, HaveNoCertificateWhereTheyAreTooFewWithWhatStays) {
  auto structure = beam(Eigen::VectorXd::Constant(1, 0.31));
  structure.sensors.stays = {1};
  Plan plan;
  plan.modes = {1, 2, 3};
  plan.sites = 1;
  const auto few = optima_of(structure, points_of_beam(31), plan)[0];
  EXPECT_EQ(few.certificate, 0.0);
  EXPECT_NE(few.remark.find("1 site and what stays cannot tell 3 modes apart"), std::string::npos);
  plan.sites = 2;
  EXPECT_GT(optima_of(structure, points_of_beam(31), plan)[0].certificate, 0.9);
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

// A shape of NaN reached a decomposition that does not end with one, and scores were any numbers.
TEST(BestPlacesRefuse, ChannelsThatAreNotFinite) {
  const auto sites = points_of_beam(11);
  const auto refused = [&](const auto& change, const std::string& part) {
    auto structure = beam(Eigen::VectorXd::Constant(2, 0.1));
    change(structure.sensors);
    std::vector<std::string> notes;
    const auto message = refusal_of([&] { return wanted_modes(structure, sites, {}, notes); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  refused([](Channels& channels) { channels.shapes(1, 2) = kNaN; }, "is not finite");
  refused([](Channels& channels) { channels.lines.position(0, 1) = kNaN; }, "is not finite");
  refused([](Channels& channels) { channels.lines.direction.row(1) *= 2.0; }, "not of length 1");
}

}  // namespace
}  // namespace chladni::placement
