#include "identification/rigid_properties.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "base/error.h"
#include "tests/refusal.h"

namespace chladni::identification {
namespace {

struct Body {
  double mass = 19.4;
  Eigen::Vector3d centre{0.012, -0.034, 0.05};
  Eigen::Matrix3d inertia;
};

Body body(bool symmetric_in_z) {
  Body one;
  one.inertia << 0.62, -0.05, 0.03, -0.05, 0.81, -0.02, 0.03, -0.02, 1.3;
  if (symmetric_in_z)
    one.inertia(0, 2) = one.inertia(2, 0) = one.inertia(1, 2) = one.inertia(2, 1) = 0.0;
  return one;
}

// The mass matrix of motions (translation, rotation) about the origin, and its inverse between the
// channels.
Eigen::MatrixXd responses_of(const Body& one, const ChannelFrame& outputs,
                             const ChannelFrame& inputs) {
  Eigen::Matrix3d cross;
  const auto& c = one.centre;
  cross << 0, -c(2), c(1), c(2), 0, -c(0), -c(1), c(0), 0;
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(6, 6);
  mass.topLeftCorner<3, 3>() = one.mass * Eigen::Matrix3d::Identity();
  mass.topRightCorner<3, 3>() = -one.mass * cross;
  mass.bottomLeftCorner<3, 3>() = one.mass * cross;
  mass.bottomRightCorner<3, 3>() = one.inertia - one.mass * cross * cross;
  const auto origin = Eigen::Vector3d::Zero();
  return rigid_motions(outputs, origin) * mass.inverse() *
         rigid_motions(inputs, origin).transpose();
}

ChannelFrame frame(Eigen::Index n, unsigned seed, bool along_z) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  ChannelFrame result{Eigen::MatrixX3d(n, 3), Eigen::MatrixX3d(n, 3)};
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      result.places(i, a) = 0.2 * normal(random);
      result.directions(i, a) = along_z ? (a == 2 ? 1.0 : 0.0) : normal(random);
    }
    result.directions.row(i).normalize();
    if (along_z) result.places(i, 2) = 0.0;
  }
  return result;
}

RigidProduct exact(const Eigen::MatrixXd& value) {
  return {value, Eigen::MatrixXd::Zero(value.size(), value.size()), 6};
}

TEST(RigidProperties, AreThoseOfTheBodyInAnyDirections) {
  const auto truth = body(false);
  const auto outputs = frame(8, 1, false);
  const auto inputs = frame(7, 2, false);
  const auto found = rigid_properties(exact(responses_of(truth, outputs, inputs)), outputs, inputs);
  EXPECT_NEAR(found.mass, truth.mass, 1e-9 * truth.mass);
  EXPECT_LT((found.centre - truth.centre).norm(), 1e-9);
  EXPECT_LT((found.inertia - truth.inertia).norm(), 1e-9);
  EXPECT_TRUE(found.not_told.empty());
}

TEST(RigidProperties, AlongZTheHeightAndTheSpinAreNotTold) {
  const auto truth = body(true);
  const auto outputs = frame(4, 3, true);
  const auto inputs = frame(3, 4, true);
  const auto found = rigid_properties(exact(responses_of(truth, outputs, inputs)), outputs, inputs);
  EXPECT_NEAR(found.mass, truth.mass, 1e-8 * truth.mass);
  EXPECT_LT((found.centre.head<2>() - truth.centre.head<2>()).norm(), 1e-8);
  EXPECT_TRUE(std::isnan(found.centre(2)));
  EXPECT_TRUE(std::isinf(found.centre_std(2)));
  const Eigen::Matrix2d tilt = truth.inertia.topLeftCorner<2, 2>();
  EXPECT_LT((found.inertia.topLeftCorner<2, 2>() - tilt).norm(), 1e-8);
  for (Eigen::Index a = 0; a < 3; ++a) {
    EXPECT_TRUE(std::isnan(found.inertia(a, 2)) && std::isinf(found.inertia_std(2, a)));
  }
  ASSERT_EQ(found.not_told.size(), 2U);
  EXPECT_NE(found.not_told[0].find("centre of mass along z"), std::string::npos);
  EXPECT_NE(found.not_told[1].find("inertia about z"), std::string::npos);
}

TEST(RigidProperties, OnALineOnlyOneTiltIsTold) {
  auto truth = body(true);
  truth.centre(1) = 0.0;
  truth.inertia(0, 1) = truth.inertia(1, 0) = 0.0;
  auto outputs = frame(3, 5, true);
  auto inputs = frame(3, 6, true);
  outputs.places.col(1).setZero();
  inputs.places.col(1).setZero();
  const auto found = rigid_properties(exact(responses_of(truth, outputs, inputs)), outputs, inputs);
  EXPECT_NEAR(found.mass, truth.mass, 1e-8 * truth.mass);
  EXPECT_NEAR(found.centre(0), truth.centre(0), 1e-8);
  EXPECT_NEAR(found.inertia(1, 1), truth.inertia(1, 1), 1e-8);
  EXPECT_TRUE(std::isnan(found.centre(1)) && std::isnan(found.inertia(0, 0)) &&
              std::isnan(found.inertia(2, 2)));
}

// The deviations are those of many measurements: errors over their deviations have mean square 1.
TEST(RigidProperties, DeviationsAreThoseOfTheScatter) {
  const auto truth = body(false);
  const auto outputs = frame(9, 7, false);
  const auto inputs = frame(8, 8, false);
  const auto value = responses_of(truth, outputs, inputs);
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd deviation =
      2e-3 * value.cwiseAbs().maxCoeff() * (Eigen::MatrixXd::Random(9, 8).array() + 1.5).matrix();
  constexpr int kDraws = 200;
  double mass = 0.0;
  double centre = 0.0;
  double inertia = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    auto product = exact(value);
    product.value +=
        deviation.cwiseProduct(Eigen::MatrixXd::NullaryExpr(9, 8, [&] { return normal(random); }));
    product.covariance = deviation.reshaped().cwiseAbs2().asDiagonal();
    const auto found = rigid_properties(product, outputs, inputs);
    mass += std::pow((found.mass - truth.mass) / found.mass_std, 2) / kDraws;
    centre +=
        ((found.centre - truth.centre).array() / found.centre_std.array()).square().mean() / kDraws;
    inertia +=
        ((found.inertia - truth.inertia).array() / found.inertia_std.array()).square().mean() /
        kDraws;
  }
  EXPECT_NEAR(mass, 1.0, 0.35);
  EXPECT_NEAR(centre, 1.0, 0.3);
  EXPECT_NEAR(inertia, 1.0, 0.3);
}

// A sensor of a wrong gain makes products that no body has. Deviations by their noise alone would
// be hundreds of times too small; they do not depend on it then, nor on whether it is stated.
TEST(RigidProperties, AreNotSurerThanTheProductsAgree) {
  const auto truth = body(false);
  const auto outputs = frame(9, 7, false);
  const auto inputs = frame(8, 8, false);
  const Eigen::MatrixXd value = responses_of(truth, outputs, inputs);
  const double size = value.cwiseAbs().maxCoeff();
  for (Eigen::Index sensor = 0; sensor < 9; ++sensor) {
    auto wrong = value;
    wrong.row(sensor) *= 1.1;
    const auto found_with = [&](double noise) {
      auto product = exact(wrong);
      product.covariance.diagonal().setConstant(noise * noise);
      return rigid_properties(product, outputs, inputs);
    };
    const auto found = found_with(1e-6 * size);
    EXPECT_LT(std::abs(found.mass - truth.mass), 10.0 * found.mass_std) << sensor;
    for (const double noise : {1e-5 * size, 0.0}) {
      const auto other = found_with(noise);
      EXPECT_NEAR(other.mass_std / found.mass_std, 1.0, 1e-6) << sensor;
      EXPECT_LT((other.centre_std - found.centre_std).norm(), 1e-6 * found.centre_std.norm());
      EXPECT_LT((other.inertia_std - found.inertia_std).norm(), 1e-6 * found.inertia_std.norm());
    }
    // Where the stated noise explains more than is left, it counts.
    EXPECT_NEAR(found_with(2.0 * size).mass_std / found_with(1.0 * size).mass_std, 2.0, 1e-6);
  }
}

// The rows that follow from a rigid body agree with it, whatever the fit's own products did.
TEST(RigidProduct, HasTheMisfitOfTheBodyThatMadeItsRows) {
  ModalFit fit;
  fit.model.frequency_hz = fit.model.damping_ratio = Eigen::Vector2d::Zero();
  fit.model.rigid_count = 2;
  fit.model.output_shapes = Eigen::MatrixXd{{1.0, 0.2}, {0.9, -0.3}, {1.1, 0.4}};
  fit.model.input_shapes = fit.model.output_shapes.topRows(2).transpose();
  fit.rigid_covariance = 1e-6 * Eigen::MatrixXd::Identity(10, 10);
  GainMatch match;
  match.shapes = fit.model.output_shapes;
  match.input_shapes = fit.model.input_shapes;
  const auto plain = rigid_product(fit, match, {});
  match.rigid.emplace();
  match.rigid->misfit = 0.5;
  EXPECT_EQ(rigid_product(fit, match, {}).covariance, plain.covariance);
  match.rigid->misfit = 400.0;
  EXPECT_LT((rigid_product(fit, match, {}).covariance - 400.0 * plain.covariance).norm(),
            1e-12 * 400.0 * plain.covariance.norm());
}

// A sensor and an actuator that are not measured say nothing: all is as without them.
TEST(RigidProperties, UnmeasuredChannelsChangeNothingAndMakeNothingExact) {
  const auto outputs = frame(9, 7, false);
  const auto inputs = frame(8, 8, false);
  std::mt19937 random(21);
  std::normal_distribution<double> normal;
  const auto drawn = [&](Eigen::Index n, Eigen::Index m) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, m, [&] { return normal(random); }));
  };
  const auto truth = body(false);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(responses_of(truth, outputs, inputs),
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  ModalFit fit;
  fit.model.frequency_hz = fit.model.damping_ratio = Eigen::VectorXd::Zero(6);
  fit.model.rigid_count = 6;
  const Eigen::VectorXd root = svd.singularValues().head(6).cwiseSqrt();
  fit.model.output_shapes = svd.matrixU().leftCols(6) * root.asDiagonal();
  fit.model.input_shapes = root.asDiagonal() * svd.matrixV().leftCols(6).transpose();
  const Eigen::MatrixXd scatter = 1e-4 * drawn(102, 102);  // (9 + 8) × 6
  fit.rigid_covariance = scatter * scatter.transpose();
  const auto properties = [&](const std::vector<Eigen::Index>& rows,
                              const std::vector<Eigen::Index>& columns) {
    auto part = fit;
    std::vector<Eigen::Index> factors;
    for (int m = 0; m < 6; ++m) {
      for (const auto i : rows) factors.push_back(i + 9 * m);
    }
    for (const auto j : columns) {
      for (int m = 0; m < 6; ++m) factors.push_back(54 + m + 6 * j);
    }
    part.rigid_covariance = fit.rigid_covariance(factors, factors);
    part.model.output_shapes = fit.model.output_shapes(rows, Eigen::all);
    part.model.input_shapes = fit.model.input_shapes(Eigen::all, columns);
    GainMatch match;
    match.shapes = part.model.output_shapes;
    match.input_shapes = part.model.input_shapes;
    return rigid_properties(
        rigid_product(part, match, {}),
        {outputs.places(rows, Eigen::all), outputs.directions(rows, Eigen::all)},
        {inputs.places(columns, Eigen::all), inputs.directions(columns, Eigen::all)});
  };
  const auto expected = properties({0, 1, 2, 4, 5, 6, 7, 8}, {1, 2, 3, 4, 5, 6, 7});
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  fit.model.output_shapes.row(3).setConstant(0.01);
  fit.model.input_shapes.col(0).setConstant(-0.02);
  for (int m = 0; m < 6; ++m) {
    fit.rigid_covariance(3 + 9 * m, 3 + 9 * m) = kInfinite;
    fit.rigid_covariance(54 + m, 54 + m) = kInfinite;
  }
  const auto found = properties({0, 1, 2, 3, 4, 5, 6, 7, 8}, {0, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_NEAR(found.mass, expected.mass, 1e-9 * expected.mass);
  EXPECT_GT(found.mass_std, 0.0);
  EXPECT_NEAR(found.mass_std, expected.mass_std, 1e-6 * expected.mass_std);
  EXPECT_LT((found.centre_std - expected.centre_std).norm(), 1e-6 * expected.centre_std.norm());
  EXPECT_LT((found.inertia_std - expected.inertia_std).norm(), 1e-6 * expected.inertia_std.norm());
}

TEST(RigidProperties, AWrongPolarityIsNoBody) {
  const auto outputs = frame(4, 3, true);
  const auto inputs = frame(3, 4, true);
  const Eigen::MatrixXd value = -responses_of(body(true), outputs, inputs);
  EXPECT_THROW((void)rigid_properties(exact(value), outputs, inputs), NumericalFailure);
}

TEST(RigidProduct, IsTheSumOverModesWithItsCovariance) {
  ModalFit fit;
  fit.model.frequency_hz = Eigen::Vector3d(0.0, 0.0, 3.0);
  fit.model.damping_ratio = Eigen::Vector3d(0.0, 0.0, 0.01);
  fit.model.rigid_count = 2;
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const auto drawn = [&](Eigen::Index n, Eigen::Index m) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, m, [&] { return normal(random); }));
  };
  fit.model.output_shapes = drawn(3, 3);
  fit.model.input_shapes = drawn(3, 2);
  const Eigen::MatrixXd rigid = 1e-4 * drawn(10, 10);  // factors: (3 + 2) × 2 and 2 + 3 + 2
  const Eigen::MatrixXd third = 1e-4 * drawn(7, 7);
  fit.rigid_covariance = rigid * rigid.transpose();
  fit.mode_covariance.assign(3, third * third.transpose());
  GainMatch match;
  match.shapes = fit.model.output_shapes;
  match.input_shapes = fit.model.input_shapes;
  const auto product = rigid_product(fit, match, {2});
  EXPECT_EQ(product.modes, 3);
  EXPECT_LT((product.value - fit.model.output_shapes * fit.model.input_shapes).norm(), 1e-14);
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(6, 6);
  constexpr int kDraws = 20000;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::VectorXd d = rigid * drawn(10, 1);
    const Eigen::VectorXd e = third * drawn(7, 1);
    Eigen::MatrixXd l = fit.model.output_shapes;
    Eigen::MatrixXd r = fit.model.input_shapes;
    l.leftCols(2) += d.head(6).reshaped(3, 2);
    r.topRows(2) += d.tail(4).reshaped(2, 2);
    l.col(2) += e.segment(2, 3);
    r.row(2) += e.tail(2).transpose();
    const Eigen::VectorXd change = (l * r - product.value).reshaped();
    scatter += change * change.transpose() / kDraws;
  }
  EXPECT_LT((scatter - product.covariance).norm(), 0.05 * scatter.norm());
  EXPECT_NE(refusal_of([&] { return rigid_product(fit, match, {3}); }).find("suspended"),
            std::string::npos);
}

TEST(Decoupling, OfSensorsGivesTheMotionThatMovedThem) {
  const Eigen::Vector3d about(0.01, 0.02, -0.03);
  const auto all = frame(8, 12, false);
  const auto six = sensor_decoupling(all, about);
  EXPECT_EQ(six.told.size(), 6U);
  EXPECT_LT((six.matrix * rigid_motions(all, about) - Eigen::MatrixXd::Identity(6, 6)).norm(),
            1e-12);
  const auto flat = frame(4, 13, true);
  const auto three = sensor_decoupling(flat, about);
  EXPECT_EQ(three.told, (std::vector<Eigen::Index>{2, 3, 4}));
  EXPECT_EQ(three.unseen, (std::vector<Eigen::Index>{0, 1, 5}));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 6);
  expected(0, 2) = expected(1, 3) = expected(2, 4) = 1.0;
  EXPECT_LT((three.matrix * rigid_motions(flat, about) - expected).norm(), 1e-12);
  EXPECT_NE(
      decoupling_text(three, false).find("4 sensors tell z, rx, ry apart, 1 more than needed"),
      std::string::npos);
  EXPECT_NE(decoupling_text(three, false).find("x, y, rz not at all"), std::string::npos);
}

// Files in single precision turn normals by 1e-7: that is no motion in the plane.
TEST(Decoupling, TakesNoRoundingOfDirectionsForAMotion) {
  auto flat = frame(4, 13, true);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (double& one : flat.directions.reshaped()) one += 1e-7 * normal(random);
  const auto found = sensor_decoupling(flat, Eigen::Vector3d(0.01, 0.02, -0.03));
  EXPECT_EQ(found.rank, 3);
  EXPECT_EQ(found.told, (std::vector<Eigen::Index>{2, 3, 4}));
}

TEST(Decoupling, OfActuatorsMakesTheForceThatIsWanted) {
  const Eigen::Vector3d about(0.01, 0.02, 0.0);
  const auto flat = frame(5, 14, true);
  const auto found = actuator_decoupling(flat, about);
  const Eigen::MatrixXd forces = rigid_motions(flat, about).transpose() * found.matrix;
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(6, 3);
  expected(2, 0) = expected(3, 1) = expected(4, 2) = 1.0;
  EXPECT_LT((forces - expected).norm(), 1e-12);
  EXPECT_NE(decoupling_text(found, true).find("over-actuated"), std::string::npos);
  EXPECT_NE(decoupling_text(found, true).find("under-actuated"), std::string::npos);
}

TEST(Decoupling, OfTwoOnALineMixesHeightAndTilt) {
  ChannelFrame one{Eigen::MatrixX3d::Zero(1, 3), Eigen::MatrixX3d::Zero(1, 3)};
  one.places(0, 0) = 0.1;
  one.directions(0, 2) = 1.0;
  const auto found = sensor_decoupling(one, Eigen::Vector3d::Zero());
  EXPECT_TRUE(found.told.empty());
  EXPECT_EQ(found.mixed, (std::vector<Eigen::Index>{2, 4}));
  EXPECT_NE(decoupling_text(found, false).find("z, ry only together with others"),
            std::string::npos);
}

TEST(Decoupling, NeedsPlacesAndDirectionsOfAllChannels) {
  modal::MeasuredChannel known;
  known.position = Eigen::Vector3d(0.1, 0.0, 0.0);
  known.direction = Eigen::Vector3d(0.0, 0.0, -2.0);
  ASSERT_TRUE(channel_frame({known}));
  EXPECT_EQ(channel_frame({known})->directions(0, 2), -1.0);
  auto unknown = known;
  unknown.position.reset();
  EXPECT_FALSE(channel_frame({known, unknown}));
  EXPECT_FALSE(channel_frame({}));
}

}  // namespace
}  // namespace chladni::identification
