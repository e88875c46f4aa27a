#include "placement/heat_map.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "placement/best_pairs.h"
#include "tests/placement/plate.h"

namespace chladni::placement {
namespace {

// What gain matching over one pair gives for every mode: the error of ln α over many experiments,
// root mean square, of the worst mode; and of the output matrix extended by the actuators.
struct TrueError {
  double alpha, extended;
};

TrueError true_error(const PairView& view, const Sampler& sampler, const Sites& site,
                     const std::vector<Eigen::Index>& wanted, const Eigen::MatrixXd& actuators) {
  constexpr int kDraws = 400;
  std::mt19937 random(21);
  std::normal_distribution<double> normal;
  Eigen::VectorXd alpha = Eigen::VectorXd::Zero(view.shapes.cols());
  Eigen::VectorXd extended = alpha;
  const auto placed = [&] {
    Eigen::Vector3d at = site.position.row(0).transpose();
    at += view.position_error * Eigen::Vector3d(normal(random), normal(random), 0.0);
    at = at.cwiseMax(Eigen::Vector3d(-0.3, -0.3, 0.0)).cwiseMin(Eigen::Vector3d(0.3, 0.3, 0.0));
    return Eigen::VectorXd(
        sampler.at({*sampler.finder().from_above(at.x(), at.y())}).shapes(0, wanted).transpose());
  };
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::VectorXd sensor = placed(), actuator = placed();
    for (Eigen::Index i = 0; i < alpha.size(); ++i) {
      const double gain = std::exp(0.3 * normal(random));  // the true alpha
      const double left = gain * (sensor(i) + view.sensor_noise(i) * normal(random));
      const double right = (actuator(i) + view.actuator_noise(i) * normal(random)) / gain;
      // (5.5) for one pair; a wrong sign is as bad as an error of one.
      const double found = left * right > 0.0 ? std::sqrt(left / right) : 0.0;
      const double off = found > 0.0 ? std::min(1.0, std::abs(std::log(found / gain))) : 1.0;
      alpha(i) += off * off / kDraws;
      double missed = 0.0;
      for (Eigen::Index a = 0; a < actuators.rows(); ++a) {
        const double row = (actuators(a, i) + view.actuator_noise(i) * normal(random)) / gain;
        missed += std::pow(found * found * row - gain * actuators(a, i), 2) / std::pow(gain, 2);
      }
      extended(i) += missed / actuators.col(i).squaredNorm() / kDraws;
    }
  }
  return {std::sqrt(alpha.maxCoeff()), std::sqrt(extended.maxCoeff())};
}

class Choosing : public ::testing::Test {
 protected:
  const Plate& plate_ = square_plate();
  Sampler sampler_{plate_.body, plate_.modes, {Eigen::Vector3d::UnitZ(), 0.0}};
  Surface surface_ = sampler_.surface({"top"});
  std::vector<Eigen::Index> wanted_{6, 7, 8, 13, 14};  // simple ones: pairs need two
  Eigen::MatrixXd actuators_;
  PairView view_;

  void SetUp() override {
    view_ = view_of(plate_, surface_, surface_.sites, wanted_);
    // Noise of FRFs of one size on every line: high modes drown (their peak is φφ/(2ζω²)).
    const Eigen::VectorXd f = plate_.modes.frequency_hz(wanted_);
    view_.sensor_noise = 0.002 * view_.rms(0) * (f / f(0)).array().pow(1.5).matrix();
    view_.actuator_noise = view_.sensor_noise;
    view_.position_error = 1e-3;
    std::vector<mesh::Site> places;
    for (const double x : {-0.27, -0.11, 0.13, 0.28}) {
      for (const double y : {-0.2, 0.06, 0.26}) {
        places.push_back(*sampler_.finder().from_above(x, y));
      }
    }
    actuators_ = sampler_.at(places).shapes(Eigen::all, wanted_);
    view_.actuators = actuators_;
  }

  TrueError at_best_of(const char* name) {
    const auto map = heat_map(criterion(name), views_of({view_}));
    Eigen::Index best = 0;
    map.score.maxCoeff(&best);
    return true_error(view_, sampler_, part(surface_.sites, {best}), wanted_, actuators_);
  }
};

TEST_F(Choosing, ByTheNoiseGivesASmallerTrueErrorThanByDistanceFromNodalLines) {
  const auto thesis = at_best_of("weakest_mode");
  const auto noise = at_best_of("alpha_uncertainty");
  EXPECT_LT(noise.alpha, 0.8 * thesis.alpha);
  EXPECT_LT(noise.extended, 0.9 * thesis.extended);
  EXPECT_LE(at_best_of("extended_rows").extended, 1.05 * noise.extended);
  RecordProperty("alpha_percent_thesis", std::to_string(100 * thesis.alpha));
  RecordProperty("alpha_percent_noise_aware", std::to_string(100 * noise.alpha));
}

TEST_F(Choosing, TheScorePredictsTheTrueError) {
  const auto map = heat_map(criterion("alpha_uncertainty"), views_of({view_}));
  int tried = 0;
  for (Eigen::Index i = 0; i < surface_.sites.count(); i += 41) {
    const double predicted = 1.0 / map.score(i);
    if (predicted > 0.15) continue;  // first order, for small errors
    ++tried;
    const auto found = true_error(view_, sampler_, part(surface_.sites, {i}), wanted_, actuators_);
    EXPECT_NEAR(found.alpha / predicted, 1.0, 0.25) << surface_.sites.position.row(i);
  }
  EXPECT_GE(tried, 3);
}

TEST_F(Choosing, PairsOneAfterTheOtherNeverLoses) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(surface_.sites.count()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Eigen::Index>(i);
  const auto chosen = chosen_pairs(criterion("alpha_uncertainty"), views_of({view_}), Over::worst,
                                   surface_.sites.position, all, 0.1, 4);
  for (std::size_t k = 1; k < chosen.size(); ++k) {
    EXPECT_GT(chosen[k].score, chosen[k - 1].score);
    for (std::size_t j = 0; j < k; ++j) {
      EXPECT_GE((surface_.sites.position.row(chosen[k].site) -
                 surface_.sites.position.row(chosen[j].site))
                    .norm(),
                0.1);
    }
  }
  EXPECT_THROW((void)chosen_pairs(criterion("alpha_uncertainty"), views_of({view_}), Over::worst,
                                  surface_.sites.position, all, 1.0, 2),
               InvalidInput);
}

TEST_F(Choosing, OverAnEnsembleTheWorstIsNeverAboveTheMean) {
  auto other = view_;
  other.shapes = view_.shapes.rowwise().reverse().eval();
  const auto& weakest = criterion("weakest_mode");
  const auto worst = heat_map(weakest, views_of({view_, other}), Over::worst);
  const auto mean = heat_map(weakest, views_of({view_, other}), Over::mean);
  EXPECT_LE((worst.by_group - mean.by_group).maxCoeff(), 1e-12);
  EXPECT_TRUE(heat_map(weakest, views_of({view_, view_}), Over::mean)
                  .by_group.isApprox(heat_map(weakest, views_of({view_})).by_group, 1e-12));
  EXPECT_THROW((void)heat_map(weakest, views_of({})), InvalidInput);
}

TEST(BestSites, AreApartAndFallInScore) {
  Points position(5, 3);
  position << 0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0;
  Eigen::VectorXd score(5);
  score << 5, 4, 3, 4, 1;
  EXPECT_EQ(best_sites(score, position, {0, 1, 2, 3, 4}, 1.5, 3),
            (std::vector<Eigen::Index>{0, 3}));
  EXPECT_EQ(best_sites(score, position, {1, 2, 4}, 0.0, 2), (std::vector<Eigen::Index>{1, 2}));
}

// The best pair of the square plate, that is `scale` times as large as usual.
BestPair best_pair_at(double scale) {
  auto small = square_plate();
  small.body.points *= scale;
  const Sampler sampler(small.body, small.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  const auto surface = sampler.surface({"top"});
  Structure structure;
  structure.frequency_hz = small.modes.frequency_hz;
  structure.damping_ratio = small.modes.damping_ratio;
  structure.rigid_count = 6;
  structure.mass_kg = 1.0;
  structure.size = 0.85 * scale;
  Plan plan;
  plan.modes = {1, 2, 3, 6};
  std::vector<std::string> notes;
  const PairViews views(structure, surface.sites,
                        wanted_modes(structure, surface.sites, plan, notes), plan);
  return best_pairs(views, surface.sites, candidates_on(surface, {}), plan, &sampler, {})
      .best.front();
}

// A fixed last step of 0.05 mm is none on a body of 0.6 mm, whose pairs stayed on the candidates.
TEST(BestPairs, OfASmallBodyClimbToTheTopOfTheirHill) {
  const auto usual = best_pair_at(1.0);
  const auto small = best_pair_at(1e-3);
  EXPECT_NEAR(small.score, usual.score, 1e-3 * usual.score);
}

std::size_t most_memory() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<std::size_t>(used.ru_maxrss) * 1024;
}

// Sixty models at 10 000 places: all at once they were 110 MB.
TEST(BestPairs, TakeOneMemberOfTheEnsembleAfterTheOther) {
  constexpr Eigen::Index kPlaces = 10'000, kModes = 6, kMembers = 60;
  Sites sites;
  sites.position = Points::Zero(kPlaces, 3);
  sites.position.col(0) = Eigen::VectorXd::LinSpaced(kPlaces, 0.0, 1.0);
  sites.normal = Eigen::RowVector3d::UnitZ().replicate(kPlaces, 1);
  sites.patch = Eigen::VectorXi::Zero(kPlaces);
  sites.area = Eigen::VectorXd::Ones(kPlaces);
  sites.whole.assign(kPlaces, 1);
  sites.shapes.resize(kPlaces, kModes);
  for (Eigen::Index j = 0; j < kModes; ++j) {
    sites.shapes.col(j) =
        ((1.0 + static_cast<double>(j)) * 3.0 * sites.position.col(0).array()).sin();
  }
  sites.slopes = Eigen::MatrixXd::Ones(kPlaces, kModes);
  Structure structure;
  structure.frequency_hz = Eigen::VectorXd::LinSpaced(kModes, 10.0, 100.0);
  structure.damping_ratio = Eigen::VectorXd::Constant(kModes, 0.01);
  structure.mass_kg = structure.size = 1.0;
  structure.ensemble.assign(kMembers,
                            {structure.frequency_hz, Eigen::MatrixXd::Identity(kModes, kModes)});
  Plan plan;
  plan.modes = {1, 2, 3, 4, 5, 6};
  plan.pairs = 2;
  std::vector<std::string> notes;
  const PairViews views(structure, sites, wanted_modes(structure, sites, plan, notes), plan);
  const auto before = most_memory();
  const auto places = best_pairs(views, sites, {sites, true}, plan, nullptr, {});
  EXPECT_EQ(places.pairs.size(), 2U);
  EXPECT_LT(most_memory() - before, 30U << 20U);
}

}  // namespace
}  // namespace chladni::placement
