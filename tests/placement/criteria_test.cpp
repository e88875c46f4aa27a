#include "placement/criteria.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "placement/refine.h"
#include "tests/placement/plate.h"

namespace chladni::placement {
namespace {

// Random shapes of a group of one, a pair and a triple; p pairs in place.
PairView random_view(Eigen::Index pairs, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](Eigen::Index rows) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, 6, [&] { return normal(random); }));
  };
  PairView view;
  view.groups = {{0, 1}, {1, 2}, {3, 3}};
  view.shapes = draw(40);
  view.slopes = draw(40).cwiseAbs();
  view.present = draw(pairs);
  view.present_slopes = draw(pairs).cwiseAbs();
  view.actuators = draw(5);
  view.largest = Eigen::Vector3d(2.0, 3.0, 2.5);
  view.rms = Eigen::Vector3d(1.0, 1.1, 0.9);
  view.sensor_noise = Eigen::VectorXd::Constant(6, 0.02);
  view.actuator_noise = Eigen::VectorXd::Constant(6, 0.03);
  view.position_error = 1e-3;
  return view;
}

class EveryCriterion : public ::testing::TestWithParam<const Criterion*> {};

TEST_P(EveryCriterion, IsFiniteAndNotNegative) {
  const auto score = GetParam()->score(random_view(2, 1));
  EXPECT_TRUE(score.allFinite());
  EXPECT_GE(score.minCoeff(), 0.0);
  EXPECT_EQ(score.rows(), 40);
  EXPECT_EQ(score.cols(), 3);
}

TEST_P(EveryCriterion, IsBlindToTheSignOfAMode) {
  for (const Eigen::Index pairs : {0, 1, 3}) {
    auto view = random_view(pairs, 2);
    const auto before = GetParam()->score(view);
    for (auto* shapes : {&view.shapes, &view.present, &view.actuators}) {
      shapes->col(0) *= -1.0;
      shapes->col(4) *= -1.0;
    }
    EXPECT_TRUE(GetParam()->score(view).isApprox(before, 1e-12)) << pairs << " pairs";
  }
}

TEST_P(EveryCriterion, IsBlindToARotationWithinAGroup) {
  const Eigen::Matrix2d two = Eigen::Rotation2Dd(0.7).toRotationMatrix();
  const Eigen::Matrix3d three =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const Eigen::Index pairs : {0, 1, 2, 4}) {
    auto view = random_view(pairs, 3);
    view.position_error = 0.0;  // slopes are lengths of gradients, turned below they would not be
    const auto before = GetParam()->score(view);
    for (auto* shapes : {&view.shapes, &view.present, &view.actuators}) {
      shapes->middleCols(1, 2) *= two;
      shapes->middleCols(3, 3) *= three;
    }
    EXPECT_TRUE(GetParam()->score(view).isApprox(before, 1e-10)) << pairs << " pairs";
  }
}

TEST_P(EveryCriterion, NeverFallsWhenAPairIsAdded) {
  auto view = random_view(3, 4);
  const auto before = GetParam()->score(view);
  view.present.conservativeResize(4, Eigen::NoChange);
  view.present.row(3) = view.shapes.row(7);
  view.present_slopes.conservativeResize(4, Eigen::NoChange);
  view.present_slopes.row(3) = view.slopes.row(7);
  EXPECT_GE((GetParam()->score(view) - before).minCoeff(), -1e-12);
}

TEST_P(EveryCriterion, ScoresNothingOnANodalLine) {
  auto view = random_view(0, 5);
  view.shapes(11, 0) = 0.0;
  const auto score = GetParam()->score(view);
  EXPECT_LT(score(11, 0), 1e-6 * score.col(0).maxCoeff());
}

// On a square plate, every mode's map has the plate's own symmetry, pairs included.
TEST_P(EveryCriterion, HasTheSymmetryOfTheBody) {
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  const auto surface = sampler.surface({"top"});
  std::vector<mesh::Site> places;
  for (const auto& [x, y] : {std::pair(0.21, 0.13),
                             {0.13, 0.21},
                             {-0.21, 0.13},
                             {-0.13, -0.21},
                             {0.21, -0.13},
                             {-0.21, -0.13},
                             {0.13, -0.21},
                             {-0.13, 0.21}}) {
    places.push_back(*sampler.finder().from_above(x, y));
  }
  const auto wanted = flexible(1, 9);
  const auto map =
      heat_map(*GetParam(), views_of({view_of(plate, surface, sampler.at(places), wanted)}));
  const double spread = map.score.maxCoeff() / map.score.minCoeff();
  EXPECT_LT(spread, 1.02) << map.score.transpose();
}

INSTANTIATE_TEST_SUITE_P(Criteria, EveryCriterion,
                         ::testing::ValuesIn(criteria().begin(), criteria().end()),
                         [](const auto& one) { return std::string(one.param->name); });

TEST(WeakestMode, IsTheSourcesFormulaForSimpleModes) {
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {});
  const auto surface = sampler.surface({"top"});
  const auto wanted = flexible(1, 3);
  const auto map = heat_map(criterion("weakest_mode"),
                            views_of({view_of(plate, surface, surface.sites, wanted)}));
  const Eigen::MatrixXd z = surface.sites.shapes(Eigen::all, wanted).cwiseAbs();
  const Eigen::RowVectorXd largest = z.colwise().maxCoeff();
  for (Eigen::Index i = 0; i < z.rows(); ++i) {
    EXPECT_NEAR(map.score(i), z.row(i).cwiseQuotient(largest).minCoeff(), 1e-12);
  }
}

TEST(WeakestMode, OfTheOatIsBestOnTheRimAwayFromItsCorners) {
  const auto& plate = square_plate();
  const Sampler sampler(plate.body, plate.modes, {});
  const auto surface = sampler.surface({"top"});
  const Worth worth = [&](const Sites& sites) {
    return heat_map(criterion("weakest_mode"),
                    views_of({view_of(plate, surface, sites, flexible(1, 3))}))
        .score;
  };
  Eigen::Index start = 0;
  worth(surface.sites).maxCoeff(&start);
  const auto best = refined(sampler, part(surface.sites, {start}), worth, 0.02, 1e-4);
  EXPECT_NEAR(worth(best)(0), 0.54, 0.01);  // a Kirchhoff plate: 0.54 at (300, -186) mm
  const Eigen::RowVector3d at = best.position.row(0).cwiseAbs();
  EXPECT_NEAR(std::max(at.x(), at.y()), 0.300, 1e-9);
  EXPECT_NEAR(std::min(at.x(), at.y()), 0.186, 0.003);
}

TEST(AlphaUncertainty, IsTheSpreadOfTheEstimateOverManyNoises) {
  auto view = random_view(0, 6);
  view.groups = {{0, 1}};
  view.position_error = 0.0;
  const double phi = view.shapes(3, 0) = 0.7;
  const double expected = alpha_deviation(view)(3, 0);
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const int draws = 20000;
  double square = 0.0;
  for (int k = 0; k < draws; ++k) {
    const double left = phi + view.sensor_noise(0) * normal(random);
    const double right = phi + view.actuator_noise(0) * normal(random);
    const double log_alpha = 0.5 * std::log(left / right);
    square += log_alpha * log_alpha;
  }
  EXPECT_NEAR(std::sqrt(square / draws) / expected, 1.0, 0.02);
}

TEST(Criterion, OfAnUnknownNameListsThoseThereAre) {
  try {
    (void)criterion("weekest_mode");
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("weakest_mode"), std::string::npos);
  }
}

}  // namespace
}  // namespace chladni::placement
