// Gaussian processes on distances as ways to interpolate shapes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "priors/interpolator.h"
#include "priors/methods/shape_symmetry.h"
#include "priors/simulated_lengths.h"
#include "rotation/turn.h"

namespace chladni::priors {
namespace {

using std::numbers::pi;

constexpr double kSide = 0.6;
constexpr double kNoise = 0.01;

Points grid(int columns, int rows, double length, double width) {
  Points points = Points::Zero(Eigen::Index{columns} * rows, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto at = [](Eigen::Index k, int count) {
      return count == 1 ? 0.0 : static_cast<double>(k) / (count - 1) - 0.5;
    };
    points(i, 0) = length * at(i % columns, columns);
    points(i, 1) = width * at(i / columns, rows);
  }
  return points;
}

// 1, x, y, then products of cosines that are orthogonal over the square: modes of a membrane with a
// free rim.
constexpr int kWaves[][2] = {{1, 1}, {2, 0}, {0, 2}, {2, 1}, {1, 2}, {2, 2}, {3, 1}};
constexpr Eigen::Index kRigid = 3;

Eigen::MatrixXd shapes_at(const Points& at) {
  Eigen::MatrixXd shapes(at.rows(), kRigid + std::ssize(kWaves));
  shapes.col(0).setOnes();
  shapes.col(1) = at.col(0) / kSide;
  shapes.col(2) = at.col(1) / kSide;
  for (Eigen::Index j = kRigid; j < shapes.cols(); ++j) {
    const auto& wave = kWaves[j - kRigid];
    shapes.col(j) = (pi * wave[0] * (at.col(0).array() / kSide + 0.5)).cos() *
                    (pi * wave[1] * (at.col(1).array() / kSide + 0.5)).cos();
  }
  return shapes;
}

Places places_at(const Points& at) {
  return {at, Eigen::RowVector3d::UnitZ().replicate(at.rows(), 1), shapes_at(at)};
}

Simulation simulation_on(const Points& surface) {
  Simulation simulation;
  simulation.surface = places_at(surface);
  simulation.area = Eigen::VectorXd::Constant(surface.rows(),
                                              kSide * kSide / static_cast<double>(surface.rows()));
  simulation.frequency_hz.resize(simulation.surface.shapes.cols());
  simulation.frequency_hz.setZero();
  for (Eigen::Index j = kRigid; j < simulation.frequency_hz.size(); ++j) {
    const auto& wave = kWaves[j - kRigid];
    simulation.frequency_hz(j) = 50.0 * (wave[0] * wave[0] + wave[1] * wave[1]);
  }
  return simulation;
}

// Columns of the simulation, a little louder, with noise.
MeasuredShapes measured_at(const Points& at, const std::vector<Eigen::Index>& columns,
                           double louder = 1.7) {
  const auto simulation = simulation_on(at);
  MeasuredShapes measured;
  measured.places = simulation.surface;
  measured.frequency_hz = 1.05 * simulation.frequency_hz(columns);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd noise = Eigen::MatrixXd::NullaryExpr(
      at.rows(), std::ssize(columns), [&] { return kNoise * normal(random); });
  measured.values = louder * (simulation.surface.shapes(Eigen::all, columns) + noise);
  measured.noise = Eigen::MatrixXd::Constant(at.rows(), std::ssize(columns), louder * kNoise);
  return measured;
}

const std::vector<Eigen::Index> kFlexible = {3, 4, 5, 6, 7};

std::vector<const Interpolator*> euclidean() {
  std::vector<const Interpolator*> some;
  for (const auto* name : {"squared_exponential", "squared_exponential_per_mode",
                           "squared_exponential_symmetrised", "squared_exponential_matched",
                           "squared_exponential_evidence", "matern_5_2", "matern_3_2"}) {
    some.push_back(&interpolator(name));
  }
  return some;
}

class EveryEuclidean : public ::testing::TestWithParam<const Interpolator*> {
 protected:
  const Interpolator& method_ = *GetParam();
  Simulation simulation_ = simulation_on(grid(25, 25, kSide, kSide));
  MeasuredShapes measured_ = measured_at(grid(6, 6, 0.5, 0.5), kFlexible);

  std::string refusal(const MeasuredShapes& measured) const {
    try {
      (void)mode_field(method_, measured, simulation_);
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  }
};

TEST_P(EveryEuclidean, ComesNearTheShapesItSeesWell) {
  const auto field = mode_field(method_, measured_, simulation_)->at(simulation_.surface);
  const Eigen::MatrixXd truth = 1.7 * simulation_.surface.shapes(Eigen::all, kFlexible);
  const auto error = squared_error(field.mean, truth, simulation_.area);
  EXPECT_LT(error.maxCoeff(), 0.05) << error.transpose();
  EXPECT_GT(coverage(field, truth, simulation_.area).mean(), 0.7);
}

TEST_P(EveryEuclidean, HoldsToTheValuesAsFarAsTheirNoiseGoes) {
  const auto field = mode_field(method_, measured_, simulation_)->at(measured_.places);
  EXPECT_LT((field.mean - measured_.values).cwiseAbs().maxCoeff(), 5.0 * 1.7 * kNoise);
  EXPECT_GT(field.deviation.minCoeff(), 0.0);
  const auto beyond = mode_field(method_, measured_, simulation_)
                          ->at(places_at(grid(2, 2, kSide, kSide)));  // the corners
  EXPECT_GT(beyond.deviation.minCoeff(), field.deviation.minCoeff());
}

TEST_P(EveryEuclidean, TakesAnyUnitSignAndOrder) {
  const auto before = mode_field(method_, measured_, simulation_)->at(simulation_.surface);
  auto other = measured_;
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = measured_.places.count(); i-- > 0;) rows.push_back(i);
  other.places = part(measured_.places, rows);
  other.values = -1e3 * measured_.values(rows, Eigen::all);
  other.noise = 1e3 * measured_.noise(rows, Eigen::all);
  const auto after = mode_field(method_, other, simulation_)->at(simulation_.surface);
  EXPECT_LT((after.mean + 1e3 * before.mean).norm(), 1e-5 * after.mean.norm());
  EXPECT_LT((after.deviation - 1e3 * before.deviation).norm(), 1e-4 * after.deviation.norm());
}

TEST_P(EveryEuclidean, SaysWhatItLearned) {
  const auto field = mode_field(method_, measured_, simulation_);
  const auto& summary = field->summary();
  ASSERT_GE(summary.parameters.size(), 2U);
  EXPECT_EQ(summary.parameters[0].name, "length_scale");
  EXPECT_EQ(summary.parameters[0].unit, "m");
  EXPECT_EQ(summary.parameters[0].value.size(), 5);
  EXPECT_GT(summary.parameters[0].value.minCoeff(), 0.02);
  EXPECT_TRUE(summary.log_evidence.allFinite());
}

TEST_P(EveryEuclidean, RefusesMixedDirections) {
  auto mixed = measured_;
  mixed.places.direction.row(4) = Eigen::RowVector3d::UnitX();
  const auto message = refusal(mixed);
  EXPECT_NE(message.find("place 5"), std::string::npos) << message;
  EXPECT_NE(message.find("one direction"), std::string::npos) << message;
  const auto field = mode_field(method_, measured_, simulation_);
  auto elsewhere = places_at(grid(2, 2, 0.1, 0.1));
  elsewhere.direction.row(1) = -Eigen::RowVector3d::UnitZ();
  EXPECT_THROW((void)field->at(elsewhere), InvalidInput);
}

TEST_P(EveryEuclidean, WorksAlongALine) {
  const auto on_the_rim = [](int count, double length) {
    Points line = grid(count, 1, length, 0.0);
    line.col(1).setConstant(-0.5 * kSide);
    return line;
  };
  const auto simulation = simulation_on(on_the_rim(80, kSide));
  const std::vector<Eigen::Index> columns = {3, 4};
  const auto measured = measured_at(on_the_rim(9, 0.55), columns);
  const auto field = mode_field(method_, measured, simulation)->at(simulation.surface);
  const Eigen::MatrixXd truth = 1.7 * simulation.surface.shapes(Eigen::all, columns);
  EXPECT_LT(squared_error(field.mean, truth, simulation.area).maxCoeff(), 0.05);
}

TEST_P(EveryEuclidean, TakesThreePlacesAndWideSpread) {
  const auto few = measured_at(grid(3, 1, 0.5, 0.0), {3, 4});
  const auto field = mode_field(method_, few, simulation_)->at(simulation_.surface);
  EXPECT_TRUE(field.mean.allFinite());
  EXPECT_TRUE(field.deviation.allFinite());
}

TEST_P(EveryEuclidean, TakesTwoChannelsAtOnePoint) {
  auto twice = measured_;
  twice.places.position.row(7) = twice.places.position.row(8);
  twice.places.shapes.row(7) = twice.places.shapes.row(8);
  twice.values.row(7) = twice.values.row(8);
  const auto field = mode_field(method_, twice, simulation_)->at(simulation_.surface);
  EXPECT_TRUE(field.mean.allFinite());
}

TEST_P(EveryEuclidean, GivesARigidBodyItsPlane) {
  const auto rigid = measured_at(grid(6, 6, 0.5, 0.5), {0, 1, 3});
  const auto field = mode_field(method_, rigid, simulation_)->at(simulation_.surface);
  const Eigen::MatrixXd truth = 1.7 * simulation_.surface.shapes.leftCols(2);
  const auto error = squared_error(field.mean.leftCols(2), truth, simulation_.area);
  EXPECT_LT(error.maxCoeff(), 0.01) << error.transpose();
}

INSTANTIATE_TEST_SUITE_P(Interpolators, EveryEuclidean, ::testing::ValuesIn(euclidean()),
                         [](const auto& one) { return std::string(one.param->name); });

TEST(SquaredExponential, HasOneLengthAndPerModeHasMany) {
  EVERY_FOURTH_LANDING();
  const auto simulation = simulation_on(grid(25, 25, kSide, kSide));
  const auto measured = measured_at(grid(6, 6, 0.5, 0.5), {3, 8});
  const auto length = [&](const char* name) -> Eigen::VectorXd {
    return mode_field(interpolator(name), measured, simulation)->summary().parameters[0].value;
  };
  const auto one = length("squared_exponential");
  const auto many = length("squared_exponential_per_mode");
  EXPECT_EQ(one(0), one(1));
  // The most complex mode in the band; a maximum is known to the root of its rounding.
  EXPECT_NEAR(one(1), many(1), 1e-6 * one(1));
  EXPECT_GT(many(0), 1.2 * many(1));
}

TEST(SquaredExponential, OfNothingIsNothing) {
  const auto simulation = simulation_on(grid(25, 25, kSide, kSide));
  auto measured = measured_at(grid(6, 6, 0.5, 0.5), {3, 4});
  measured.values.col(0).setZero();
  for (const auto* name : {"squared_exponential", "squared_exponential_matched"}) {
    const auto field = mode_field(interpolator(name), measured, simulation)->at(simulation.surface);
    EXPECT_TRUE(field.deviation.allFinite());
    EXPECT_EQ(field.mean.col(0).norm(), 0.0);
  }
}

// All places on the line y = 0, where the mode cos x cos y has its node.
TEST(SquaredExponential, SaysWhichModeThePlacesHardlySee) {
  const auto simulation = simulation_on(grid(25, 25, kSide, kSide));
  const auto blind = measured_at(grid(9, 1, 0.5, 0.0), {3, 4});
  const auto field = mode_field(interpolator("squared_exponential_matched"), blind, simulation);
  std::string notes;
  for (const auto& note : field->summary().notes) notes += note + "\n";
  EXPECT_NE(notes.find("mode 1: these places leave"), std::string::npos) << notes;
  const auto seen = mode_field(interpolator("squared_exponential_matched"),
                               measured_at(grid(6, 6, 0.5, 0.5), {3, 4}), simulation);
  for (const auto& note : seen->summary().notes) {
    EXPECT_EQ(note.find("these places leave"), std::string::npos) << note;
  }
}

// A plane has no shortest wave: the longer the length, the better, up to the end of the range.
TEST(SquaredExponential, SaysThatAMatchedLengthIsTheLongest) {
  auto simulation = simulation_on(grid(25, 25, kSide, kSide));
  auto measured = measured_at(grid(6, 6, 0.5, 0.5), {3});
  for (auto* places : {&simulation.surface, &measured.places}) {
    for (auto column : places->shapes.colwise()) {
      column = (1.0 + 0.1 * places->position.col(0).array()).matrix();
    }
  }
  measured.values.col(0) = measured.places.shapes.col(0);
  const auto field = mode_field(interpolator("squared_exponential_matched"), measured, simulation);
  const auto& length = field->summary().parameters.front();
  EXPECT_EQ(length.name, "length_scale");
  EXPECT_NEAR(length.value(0), length_range(measured.places.position).second, 1e-9);
  EXPECT_TRUE(length.at_bound);
}

TEST(SquaredExponential, NeedsAModeThatMovesTheSurface) {
  auto simulation = simulation_on(grid(25, 25, kSide, kSide));
  simulation.surface.shapes.rightCols(std::ssize(kWaves)).setZero();
  const auto measured = measured_at(grid(6, 6, 0.5, 0.5), {3});
  EXPECT_THROW((void)mode_field(interpolator("squared_exponential"), measured, simulation),
               InvalidInput);
}

TEST(ShapeSymmetries, AreThoseOfCosinesOnASquare) {
  const auto found =
      shape_symmetries(simulation_on(grid(21, 21, kSide, kSide)), Eigen::RowVector3d::UnitZ());
  ASSERT_EQ(found.size(), 10U);
  EXPECT_EQ(found[3].operations.size(), 8U);  // cos x cos y: x and y exchanged, too
  EXPECT_EQ(found[3].characters[1], -1.0);    // odd in y
  // cos 2x and cos 2y are a pair: even in both, exchanged they are each other.
  EXPECT_EQ(found[4].operations.size(), 4U);
  EXPECT_EQ(found[5].operations.size(), 4U);
  // cos 2x cos y and cos x cos 2y: only the half turn does the same to both, it turns the sign.
  EXPECT_EQ(found[6].operations.size(), 2U);
  EXPECT_EQ(found[6].characters[1], -1.0);
  EXPECT_EQ(found[8].operations.size(), 8U);
  EXPECT_LT(found[3].centre.norm(), 1e-12);
}

TEST(ShapeSymmetries, OfAnUnevenSurfaceAreTheIdentityAlone) {
  auto points = grid(21, 21, kSide, kSide);
  points.col(0).array() += 0.3 * points.col(1).array() + 1.5 * points.col(0).array().square();
  for (const auto& one : shape_symmetries(simulation_on(points), Eigen::RowVector3d::UnitZ())) {
    EXPECT_EQ(one.operations.size(), 1U);
  }
}

TEST(SpreadPoints, AreApartAndTheSameEveryTime) {
  const auto points = grid(30, 30, kSide, kSide);
  const auto rows = spread_points(points, 36);
  ASSERT_EQ(rows.size(), 36U);
  EXPECT_EQ(rows, spread_points(points, 36));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GT((points.row(rows[i]) - points.row(rows[k])).norm(), 0.06);
    }
  }
  EXPECT_EQ(spread_points(Points::Zero(5, 3), 3).size(), 0U);
  EXPECT_EQ(spread_points(points, 5000).size(), 900U);
}

}  // namespace
}  // namespace chladni::priors
