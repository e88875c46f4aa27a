#include "priors/spline/thin_plate_spline.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "simulators/portable_random.h"

namespace chladni::priors {
namespace {

using simulators::Dice;

Places flat_places(const Eigen::MatrixX2d& xy) {
  Places places;
  places.position = Points::Zero(xy.rows(), 3);
  places.position.leftCols<2>() = xy;
  places.direction = Points::Zero(xy.rows(), 3);
  places.direction.col(2).setOnes();
  return places;
}

Places random_places(Eigen::Index count, unsigned seed, double size = 0.3) {
  return flat_places(size * Dice(seed).normal(count, 2));
}

MeasuredShapes measured(const Places& places, const Eigen::MatrixXd& values, double noise) {
  MeasuredShapes shapes;
  shapes.places = places;
  shapes.frequency_hz = Eigen::VectorXd::Constant(values.cols(), 100.0);
  shapes.values = values;
  shapes.noise = Eigen::MatrixXd::Constant(values.rows(), values.cols(), noise);
  return shapes;
}

Eigen::MatrixXd wavy(const Places& places) {
  const Eigen::ArrayXd x = places.position.col(0) / 0.3;
  const Eigen::ArrayXd y = places.position.col(1) / 0.3;
  Eigen::MatrixXd values(places.count(), 2);
  values << (x.square() - y + (1.5 * y).sin()).matrix(), (x * y + (2.0 * x).cos()).matrix();
  return values;
}

constexpr SmoothingRule kRules[] = {SmoothingRule::reml_known_noise, SmoothingRule::reml,
                                    SmoothingRule::generalised_cross_validation,
                                    SmoothingRule::leave_one_out};

TEST(ThinPlateSpline, ReproducesPlanesExactly) {
  const auto places = random_places(9, 1);
  const auto elsewhere = random_places(50, 2, 1.0);
  const Eigen::Vector4d plane(0.7, -3.0, 11.0, 0.0);
  const auto on = [&](const Places& p) -> Eigen::VectorXd {
    return (p.position * plane.segment<3>(1)).array() + plane(0);
  };
  for (const auto rule : kRules) {
    const auto field = thin_plate_spline(measured(places, on(places), 0.1), {rule, {}});
    EXPECT_LT((field->at(elsewhere).mean - on(elsewhere)).norm(), 1e-11 * on(elsewhere).norm());
    EXPECT_TRUE(field->summary().parameters.at(0).at_bound);
    ASSERT_FALSE(field->summary().notes.empty());
    EXPECT_NE(field->summary().notes[0].find("plane"), std::string::npos);
  }
}

// ∫ Wxx² + 2 Wxy² + Wyy² on rings about the places out to where nothing is left.
TEST(ThinPlateSpline, HasTheEnergyThatQuadratureFinds) {
  const Eigen::MatrixXd places = Dice(4).normal(7, 2);
  Eigen::VectorXd weights = Dice(5).normal(7, 1);
  const Eigen::MatrixXd plane = plane_functions(places);
  weights -= plane * (plane.transpose() * plane).ldlt().solve(plane.transpose() * weights);
  const double energy = weights.dot(bending_kernel(places, places) * weights);

  double sum = 0.0;
  constexpr int kAround = 400;
  constexpr double kStep = 0.01;
  for (double ln = -7.0; ln < 7.0; ln += kStep) {
    const double r = std::exp(ln + 0.5 * kStep);
    for (int a = 0; a < kAround; ++a) {
      const double angle = 2.0 * std::numbers::pi * (a + 0.5) / kAround;
      double xx = 0.0, xy = 0.0, yy = 0.0;
      for (Eigen::Index k = 0; k < 7; ++k) {
        const double x = r * std::cos(angle) - places(k, 0);
        const double y = r * std::sin(angle) - places(k, 1);
        const double s = x * x + y * y;
        const double c = weights(k) / (8.0 * std::numbers::pi);
        xx += c * (std::log(s) + 1.0 + 2.0 * x * x / s);
        yy += c * (std::log(s) + 1.0 + 2.0 * y * y / s);
        xy += c * 2.0 * x * y / s;
      }
      sum += (xx * xx + 2.0 * xy * xy + yy * yy) * r * r * kStep * 2.0 * std::numbers::pi / kAround;
    }
  }
  EXPECT_NEAR(energy, sum, 2e-3 * sum);
}

TEST(ThinPlateSpline, HasOnALineTheEnergyOfABeam) {
  Eigen::MatrixXd places(4, 1);
  places << -1.0, 0.2, 0.7, 1.5;
  Eigen::VectorXd weights = Dice(5).normal(4, 1);
  const Eigen::MatrixXd plane = plane_functions(places);
  weights -= plane * (plane.transpose() * plane).ldlt().solve(plane.transpose() * weights);
  double sum = 0.0;
  constexpr double kStep = 1e-4;
  for (double x = -2.0; x < 2.0; x += kStep) {
    const double bent = 0.5 * ((x - places.array()).abs() * weights.array()).sum();
    sum += bent * bent * kStep;
  }
  EXPECT_NEAR(weights.dot(bending_kernel(places, places) * weights), sum, 1e-3 * sum);
}

TEST(ThinPlateSpline, FollowsTheValuesAsTheNoiseVanishes) {
  const auto places = random_places(13, 3);
  const auto values = wavy(places);
  const auto field = thin_plate_spline(measured(places, values, 1e-6))->at(places);
  EXPECT_LT((field.mean - values).cwiseAbs().maxCoeff(), 3e-6);
  EXPECT_LT(field.deviation.maxCoeff(), 1.01e-6);
}

TEST(ThinPlateSpline, MovesTurnsAndGrowsWithItsPlaces) {
  const auto places = random_places(13, 3);
  const auto elsewhere = random_places(30, 4);
  const auto values = wavy(places);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.8, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  const auto moved = [&](Places p) {
    p.position = ((1000.0 * p.position) * turn.transpose()).eval();
    p.position.rowwise() += Eigen::RowVector3d(40.0, -3000.0, 7.0);
    p.direction = (p.direction * turn.transpose()).eval();
    return p;
  };
  for (const auto rule : kRules) {
    const auto here = thin_plate_spline(measured(places, values, 0.05), {rule, {}});
    const auto there = thin_plate_spline(measured(moved(places), values, 0.05), {rule, {}});
    const auto a = here->at(elsewhere);
    const auto b = there->at(moved(elsewhere));
    EXPECT_LT((a.mean - b.mean).norm(), 1e-6 * a.mean.norm());
    EXPECT_LT((a.deviation - b.deviation).norm(), 1e-5 * a.deviation.norm());
    // λ of (5.11) is an area.
    const auto ratio =
        there->summary().parameters[0].value.cwiseQuotient(here->summary().parameters[0].value);
    EXPECT_NEAR(ratio(0), 1e6, 1e2);
  }
}

TEST(ThinPlateSpline, TakesEitherSenseOfTheDirection) {
  auto places = random_places(13, 3);
  auto values = wavy(places);
  const auto straight = thin_plate_spline(measured(places, values, 0.05))->at(places);
  places.direction.row(4) *= -1.0;
  values.row(4) *= -1.0;
  auto turned = thin_plate_spline(measured(places, values, 0.05))->at(places);
  EXPECT_LT((turned.deviation - straight.deviation).norm(), 1e-12);
  turned.mean.row(4) *= -1.0;
  EXPECT_LT((turned.mean - straight.mean).norm(), 1e-12);
}

TEST(ThinPlateSpline, IsACubicSplineAlongABeam) {
  Eigen::MatrixX2d xy(6, 2);
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double s = 0.1 * static_cast<double>(k * k) / 5.0;
    xy.row(k) << 0.6 * s, 0.8 * s;
  }
  const auto places = flat_places(xy);
  const Eigen::VectorXd along = xy.rowwise().norm();
  const Eigen::VectorXd values = (20.0 * along).array().sin();
  const auto field = thin_plate_spline(measured(places, values, 1e-8));
  ASSERT_FALSE(field->summary().notes.empty());
  EXPECT_NE(field->summary().notes[0].find("one line"), std::string::npos);
  // A natural spline: straight beyond its ends, and nothing changes across.
  Eigen::MatrixX2d probe(4, 2);
  probe << 0.6, 0.8, 1.2, 1.6, 1.8, 2.4, 1.2 - 0.8, 1.6 + 0.6;
  const auto at = field->at(flat_places(probe)).mean;
  EXPECT_NEAR(at(1) - at(0), at(2) - at(1), 1e-6 * std::abs(at(1)));
  EXPECT_NEAR(at(3), at(1), 1e-9 * std::abs(at(1)));
}

TEST(ThinPlateSpline, MinimisesItsCostForAGivenSmoothing) {
  const auto places = random_places(13, 3);
  const auto domain = spline_domain(places);
  const Eigen::MatrixXd knots = coordinates(domain, places.position);
  const Eigen::MatrixXd kernel = bending_kernel(knots, knots);
  const Eigen::VectorXd values = wavy(places).col(0);
  const double lambda = 1e-3;  // m²
  // Any other weights cost more; the cost in metres from its definition.
  const auto cost = [&](const Eigen::VectorXd& c, const Eigen::VectorXd& d) {
    const Eigen::VectorXd shape = kernel * c + plane_functions(knots) * d;
    return (shape - values).squaredNorm() +
           lambda * c.dot(kernel * c) / (domain.size * domain.size);
  };
  const Smoother smoother(kernel, plane_functions(knots), Eigen::VectorXd::Ones(13));
  const auto best = smoother.fit(values, lambda / (domain.size * domain.size));
  const auto field = thin_plate_spline(measured(places, values, 0.1), {{}, lambda});
  const Eigen::VectorXd shape = kernel * best.weights + plane_functions(knots) * best.trend;
  EXPECT_LT((field->at(places).mean - shape).norm(), 1e-10);
  Dice dice(8);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::VectorXd c = 0.1 * dice.normal(13, 1);
    const Eigen::MatrixXd plane = plane_functions(knots);
    c -= plane * (plane.transpose() * plane).ldlt().solve(plane.transpose() * c);
    EXPECT_LT(cost(best.weights, best.trend), cost(best.weights + c, best.trend));
  }
}

// Draws of the spline's own prior on places of a plate, any plane added.
struct Draws {
  Places knots, elsewhere;
  Eigen::MatrixXd values, truth;
};

Draws draws(Eigen::Index count, double noise) {
  constexpr Eigen::Index kKnots = 13, kOthers = 60;
  Dice dice(21);
  Eigen::MatrixX2d xy(kKnots + kOthers, 2);
  for (double& coordinate : xy.reshaped()) coordinate = dice.between(-1.0, 1.0);
  const Eigen::MatrixXd plane = plane_functions(xy);
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(plane).householderQ();
  const Eigen::MatrixXd rest = q.rightCols(xy.rows() - 3);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(rest.transpose() *
                                                             bending_kernel(xy, xy) * rest);
  const Eigen::MatrixXd root =
      rest * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd shapes =
      root * dice.normal(root.cols(), count) + plane * dice.normal(3, count);
  return {flat_places(xy.topRows(kKnots)), flat_places(xy.bottomRows(kOthers)),
          shapes.topRows(kKnots) + noise * dice.normal(kKnots, count), shapes.bottomRows(kOthers)};
}

TEST(ThinPlateSpline, CoversDrawsOfItsOwnPrior) {
  constexpr double kNoise = 0.02;
  const auto drawn = draws(400, kNoise);
  const Eigen::VectorXd area = Eigen::VectorXd::Ones(60);
  const auto covered = [&](const SplineOptions& options) {
    const auto field = thin_plate_spline(measured(drawn.knots, drawn.values, kNoise), options);
    return coverage(field->at(drawn.elsewhere), drawn.truth, area).mean();
  };
  // λ = noise² over the prior's variance, here 1/m².
  EXPECT_NEAR(covered({{}, kNoise * kNoise}), 0.95, 0.01);
  const double learned = covered({});
  EXPECT_GT(learned, 0.90);
  EXPECT_LT(learned, 0.97);
}

// Figure 5.10: a shape of many waves on few places, as the source draws it.
struct Undersensed {
  Places places, everywhere;
  Eigen::VectorXd values, truth;

  Undersensed(Eigen::Index count, double waves) {
    const auto line = [](Eigen::Index n) {
      Eigen::MatrixX2d xy = Eigen::MatrixX2d::Zero(n, 2);
      xy.col(0).setLinSpaced(0.0, 1.0);
      return flat_places(xy);
    };
    const auto shape = [&](const Places& p) -> Eigen::VectorXd {
      return (2.0 * std::numbers::pi * waves * p.position.col(0).array() + 0.4).sin();
    };
    places = line(count);
    everywhere = line(400);
    values = shape(places) + 0.01 * Dice(3).normal(count, 1);
    truth = shape(everywhere);
  }
  [[nodiscard]] double error(SmoothingRule rule) const {
    const auto field = thin_plate_spline(measured(places, values, 0.01), {rule, {}});
    return squared_error(field->at(everywhere).mean, truth, Eigen::VectorXd::Ones(400))(0);
  }
  [[nodiscard]] double covered(SmoothingRule rule) const {
    const auto field = thin_plate_spline(measured(places, values, 0.01), {rule, {}});
    return coverage(field->at(everywhere), truth, Eigen::VectorXd::Ones(400))(0);
  }
};

TEST(ThinPlateSpline, IsNotFlattenedWhereLeaveOneOutIs) {
  for (const auto& [count, waves] : {std::pair{8, 2.5}, {9, 2.5}, {9, 3.0}, {10, 3.0}}) {
    const Undersensed few(count, waves);
    EXPECT_GT(few.error(SmoothingRule::leave_one_out), 0.9) << count << " " << waves;
    EXPECT_LT(few.error(SmoothingRule::reml_known_noise), 0.05) << count << " " << waves;
    EXPECT_GT(few.covered(SmoothingRule::reml_known_noise), 0.95) << count << " " << waves;
  }
  const Undersensed enough(14, 2.0);
  EXPECT_LT(enough.error(SmoothingRule::leave_one_out), 0.001);
  EXPECT_LT(enough.error(SmoothingRule::reml_known_noise), 0.001);
}

// Where leave-one-out follows the values, the noise that it leaves is no measure of theirs.
TEST(ThinPlateSpline, DoesNotBelieveANoiseBelowTheStatedOne) {
  const Undersensed enough(14, 1.5);
  EXPECT_GT(enough.covered(SmoothingRule::leave_one_out), 0.9);
  EXPECT_GT(enough.covered(SmoothingRule::generalised_cross_validation), 0.9);
}

TEST(ThinPlateSpline, KnowsNothingOfTheBendingBetweenThreePlaces) {
  const auto places = random_places(3, 6);
  const auto field = thin_plate_spline(measured(places, Eigen::Vector3d(1.0, -2.0, 0.5), 0.1));
  const auto at = field->at(places);
  EXPECT_LT((at.mean - Eigen::Vector3d(1.0, -2.0, 0.5)).norm(), 1e-12);
  EXPECT_TRUE(at.deviation.array().isNaN().all());
  ASSERT_EQ(field->summary().notes.size(), 1U);
  EXPECT_NE(field->summary().notes[0].find("not known"), std::string::npos);
}

TEST(ThinPlateSpline, IsZeroWhereAllValuesAre) {
  const auto places = random_places(8, 6);
  for (const auto rule : kRules) {
    const auto field =
        thin_plate_spline(measured(places, Eigen::VectorXd::Zero(8), 0.1), {rule, {}});
    EXPECT_EQ(field->at(places).mean.norm(), 0.0);
    EXPECT_TRUE(field->at(places).deviation.allFinite());
  }
}

TEST(ThinPlateSpline, RefusesWhatCannotBeMeant) {
  const auto places = random_places(8, 6);
  auto askew = places;
  askew.direction.row(5) = Eigen::RowVector3d(1.0, 0.0, 0.0);
  const Eigen::VectorXd values = wavy(places).col(0);
  EXPECT_THROW((void)thin_plate_spline(measured(askew, values, 0.1)), InvalidInput);
  auto one_point = places;
  one_point.position.leftCols<2>().setConstant(0.1);
  EXPECT_THROW((void)thin_plate_spline(measured(one_point, values, 0.1)), InvalidInput);
  EXPECT_THROW(
      (void)thin_plate_spline(measured(random_places(2, 1), Eigen::Vector2d(0.0, 1.0), 0.1)),
      InvalidInput);
  const auto field = thin_plate_spline(measured(places, values, 0.1));
  EXPECT_THROW((void)field->at(askew), InvalidInput);
  EXPECT_THROW((void)thin_plate_spline(measured(places, values, 0.1), {{}, -1.0}), InvalidInput);
}

TEST(ThinPlateSpline, StandsInTheTableUnderThreeNames) {
  const auto places = random_places(13, 3);
  const auto data = measured(places, wavy(places), 0.05);
  Simulation simulation;
  simulation.surface = places;
  simulation.area = Eigen::VectorXd::Ones(13);
  for (const auto* name :
       {"thin_plate_spline", "thin_plate_spline_gcv", "thin_plate_spline_leave_one_out"}) {
    const auto field = mode_field(interpolator(name), data, simulation);
    EXPECT_TRUE(field->at(places).deviation.allFinite()) << name;
  }
}

}  // namespace
}  // namespace chladni::priors
