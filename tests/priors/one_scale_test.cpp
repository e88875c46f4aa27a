// A pinned beam, whose modes are sines, known at few places: all modes have one scale.
#include "priors/residual/one_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "priors/interpolator.h"

namespace chladni::priors {
namespace {

constexpr Eigen::Index kModes = 8;

// Mass-normalised for a mass of 2 kg and a length of 1 m.
Places places_of(const Eigen::VectorXd& x) {
  Places places{Points::Zero(x.size(), 3), Points::Zero(x.size(), 3),
                Eigen::MatrixXd(x.size(), kModes)};
  places.position.col(0) = x;
  places.direction.col(2).setOnes();
  for (Eigen::Index k = 0; k < kModes; ++k) {
    places.shapes.col(k) = (static_cast<double>(k + 1) * std::numbers::pi * x.array()).sin();
  }
  return places;
}

Simulation pinned_beam() {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(101, 0.0, 1.0);
  return {Eigen::VectorXd::LinSpaced(kModes, 1.0, kModes).cwiseAbs2() * 20.0,
          places_of(x),
          Eigen::VectorXd::Constant(101, 0.01),
          {}};
}

// Two sensors and two actuators, the first modes with the noise of a fit.
MeasuredShapes measured_at(const Eigen::VectorXd& x, Eigen::Index modes, double scale) {
  MeasuredShapes measured{places_of(x), pinned_beam().frequency_hz.head(modes) * 0.98, {}, {}};
  measured.values = scale * measured.places.shapes.leftCols(modes);
  measured.noise = Eigen::MatrixXd::Constant(x.size(), modes, 1e-3 * scale);
  measured.sides =
      BothSides{{false, false, true, true}, Eigen::VectorXd::Zero(modes), measured.noise};
  return measured;
}

const Eigen::Vector4d kPlaces(0.13, 0.37, 0.58, 0.84);
const Eigen::Vector4d kNodesOfTheFourth(0.25, 0.5, 0.75, 0.2501);

const Interpolator& default_method() { return interpolator("dynamic_residual"); }

TEST(OneScale, AShapeWhoseNodesAreAtAllPlacesIsUnknownAndNotNothing) {
  const auto measured = measured_at(kNodesOfTheFourth, 4, 3.0);
  const auto simulation = pinned_beam();
  const auto field = mode_field(default_method(), measured, simulation);
  const auto there = field->at(simulation.surface);
  const Eigen::VectorXd truth = 3.0 * simulation.surface.shapes.col(3);
  const Eigen::VectorXd away = (there.mean.col(3) - truth).cwiseAbs();
  EXPECT_GT(there.deviation.col(3).maxCoeff(), 1.0);  // of 3
  const Eigen::ArrayXd inside =
      (away.array() <= kTwoSided95 * there.deviation.col(3).array() + 1e-9).cast<double>();
  EXPECT_GT(inside.mean(), 0.95);
  // With an amplitude of its own it is told as nothing.
  auto alone = measured;
  alone.sides.reset();
  const auto other = mode_field(default_method(), alone, simulation)->at(simulation.surface);
  EXPECT_LT(other.deviation.col(3).maxCoeff(), 0.1);
}

// The pinned beam cannot move as a whole. What was measured at 0 Hz is there nevertheless, and is
// not told as 0 +- 0: it is what would have been measured at a very low frequency.
TEST(OneScale, AShapeAtRestOfAHeldBodyIsThatOfALowFrequency) {
  const auto simulation = pinned_beam();
  for (const bool two_sided : {true, false}) {
    auto rest = measured_at(kPlaces, 4, 1.0);
    if (!two_sided) rest.sides.reset();
    auto slow = rest;
    rest.frequency_hz(0) = 0.0;
    slow.frequency_hz(0) = 1e-6;
    const auto at_rest = mode_field(default_method(), rest, simulation)->at(simulation.surface);
    const auto nearly = mode_field(default_method(), slow, simulation)->at(simulation.surface);
    EXPECT_GT(at_rest.mean.col(0).norm(), 0.9 * simulation.surface.shapes.col(0).norm());
    EXPECT_GT(at_rest.deviation.col(0).maxCoeff(), 0.0);
    EXPECT_LT((at_rest.mean - nearly.mean).norm(), 1e-2 * nearly.mean.norm()) << two_sided;
  }
}

// What a sensor measures at its own place is not smoothed away by what is learned elsewhere.
TEST(OneScale, KeepsTheValuesAtItsPlaces) {
  auto measured = measured_at(kPlaces, 4, 1.0);
  measured.values.row(1) *= 1.1;  // no shape of the beam
  const auto there = mode_field(default_method(), measured, pinned_beam())->at(measured.places);
  EXPECT_LT((there.mean - measured.values).norm(), 1e-12);
  EXPECT_LT((there.deviation - measured.noise).norm(), 1e-12);
}

// A value is that of its own place. At the other end of a bar along which its device acts there was
// the same value, with the noise as its band; of two devices at one place the last one counted.
TEST(OneScale, KeepsNoValueAtTheOtherEndOfABar) {
  Simulation bar = pinned_beam();
  bar.surface.direction.col(2).setZero();
  bar.surface.direction.col(0).setOnes();
  auto measured = measured_at(Eigen::Vector4d(0.1, 0.95, 0.1, 0.6), 3, 1.0);
  measured.places.direction.col(2).setZero();
  measured.places.direction.col(0).setOnes();
  measured.values.row(2) *= 1.01;  // an actuator at the place of the first sensor
  const auto field = mode_field(default_method(), measured, bar);
  const auto there = field->at(measured.places);
  for (const Eigen::Index row : {0, 1, 3}) {
    EXPECT_LT((there.mean.row(row) - measured.values.row(row)).norm(), 1e-12) << row;
  }
  EXPECT_LT((there.mean.row(2) - measured.values.row(0)).norm(), 1e-12);
  auto elsewhere = measured.places;
  elsewhere.position(0, 0) = 0.4;
  elsewhere.shapes.row(0) = bar.surface.shapes.row(40);
  EXPECT_GT((field->at(elsewhere).mean.row(0) - measured.values.row(0)).norm(), 0.1);
  EXPECT_GT((field->at(elsewhere).mean.row(0) - measured.values.row(1)).norm(), 0.1);
}

TEST(OneScale, HasNoUnit) {
  const auto simulation = pinned_beam();
  const auto one = mode_field(default_method(), measured_at(kPlaces, 4, 1.0), simulation)
                       ->at(simulation.surface);
  const auto many = mode_field(default_method(), measured_at(kPlaces, 4, 1e4), simulation)
                        ->at(simulation.surface);
  EXPECT_LT((many.mean - 1e4 * one.mean).norm(), 1e-6 * many.mean.norm());
  EXPECT_LT((many.deviation - 1e4 * one.deviation).norm(), 1e-3 * many.deviation.norm());
}

// With an open scale between both sides the rows find it, and the field is that of the sensors.
TEST(OneScale, IsTheSensorsSideWhereTheScaleIsOpen) {
  const auto simulation = pinned_beam();
  auto measured = measured_at(kPlaces, 4, 1.0);
  const double factor = 1.4;
  measured.values.topRows(2) *= factor;
  measured.values.bottomRows(2) /= factor;
  measured.sides->log_deviation.setConstant(0.7);
  const auto field = mode_field(default_method(), measured, simulation);
  EXPECT_TRUE(field->summary().includes_scale);
  const auto there = field->at(simulation.surface);
  const Eigen::MatrixXd truth = factor * simulation.surface.shapes.leftCols(4);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double off = (there.mean.col(i) - truth.col(i)).norm() / truth.col(i).norm();
    EXPECT_LT(off, 0.3) << i;
    EXPECT_LT((there.mean.col(i) - truth.col(i)).norm(), 3.0 * there.deviation.col(i).norm()) << i;
  }
}

// Worlds drawn from the model itself: the 95 % band holds 95 % of what was not measured.
TEST(OneScale, HoldsWhatIsDrawnFromIt) {
  const auto simulation = pinned_beam();
  const auto basis = modal_basis(simulation);
  const OneScaleErrors errors{{0.2, 3.0, 0.9}, 2.0, 0.1};
  const auto there = places_of(Eigen::Vector2d(0.3, 0.71));
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  auto measured = measured_at(kPlaces, 3, 1.0);
  measured.noise.setConstant(0.02);
  measured.sides->noise = measured.noise;
  measured.sides->log_deviation.setConstant(0.3);
  int inside = 0;
  int count = 0;
  for (int world = 0; world < 400; ++world) {
    Eigen::MatrixXd hidden(2, 3);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double hz = measured.frequency_hz(i);
      Eigen::VectorXd q = coefficient_variances(basis.frequency_hz, hz, errors.prior);
      const double above = coefficient_variances(basis.beyond_hz, hz, errors.prior).sum();
      const double all = q.sum() + above;
      const double own = std::sqrt(0.01 * basis.gram.diagonal().mean() *
                                       std::sqrt(hz / measured.frequency_hz.maxCoeff()) +
                                   above * basis.beyond_square / all);
      const double amplitude = 2.0 * std::exp(0.5 * 0.4 * normal(random));
      const double delta = 0.3 * normal(random);
      Eigen::VectorXd c = (q / all).cwiseSqrt();
      for (double& one : c) one *= amplitude * normal(random);
      const auto value = [&](const Eigen::RowVectorXd& row, double sign) {
        return std::exp(sign * delta) * (row.dot(c) + amplitude * own * normal(random));
      };
      for (Eigen::Index k = 0; k < 4; ++k) {
        measured.values(k, i) =
            value(measured.places.shapes.row(k), k < 2 ? 1.0 : -1.0) + 0.02 * normal(random);
      }
      for (Eigen::Index k = 0; k < 2; ++k) hidden(k, i) = value(there.shapes.row(k), 1.0);
    }
    const OneScale body(measured, basis);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto shape = body.shape(i, errors);
      for (Eigen::Index k = 0; k < 2; ++k) {
        const Eigen::RowVectorXd row = there.shapes.row(k);
        const double deviation = std::sqrt((row * shape.root).squaredNorm() + shape.beyond);
        inside += std::abs(hidden(k, i) - row.dot(shape.mean)) <= kTwoSided95 * deviation ? 1 : 0;
        ++count;
      }
    }
  }
  const double held = static_cast<double>(inside) / count;
  EXPECT_GT(held, 0.93);
  EXPECT_LT(held, 0.97);
}

TEST(OneScale, SaysThatNothingIsCorrected) {
  auto simulation = pinned_beam();
  simulation.corrections.push_back(
      {"stiffness", Eigen::MatrixXd::Identity(kModes, kModes), {}, 0.1});
  const auto field = mode_field(default_method(), measured_at(kPlaces, 3, 1.0), simulation);
  ASSERT_FALSE(field->summary().notes.empty());
  EXPECT_NE(field->summary().notes.back().find("not corrected"), std::string::npos);
}

}  // namespace
}  // namespace chladni::priors
