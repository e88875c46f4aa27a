#include "identification/gains/rigid_body.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/error.h"
#include "modal/mac.h"
#include "simulators/portable_random.h"

namespace chladni::identification {
namespace {

Eigen::MatrixX3d random_places(Eigen::Index count, simulators::Dice& dice) {
  return 0.3 * dice.normal(count, 3);
}

// Mass, centre and second moments of a body seen from the origin.
Eigen::Matrix3d known_mass() {
  const double m = 19.4;
  const Eigen::Vector2d centre(0.02, -0.01);
  Eigen::Matrix3d mass;
  mass(0, 0) = m;
  mass.block<1, 2>(0, 1) = m * centre.transpose();
  mass.block<2, 1>(1, 0) = m * centre;
  mass.block<2, 2>(1, 1) =
      Eigen::Matrix2d{{0.6, 0.05}, {0.05, 0.5}} + m * centre * centre.transpose();
  return mass;
}

TEST(RigidBody, GivesMassCentreAndInertiaWhateverTheBlend) {
  simulators::Dice dice(3);
  const auto sensors = rigid_directions(random_places(4, dice), RigidMotion::plate);
  const auto actuators = rigid_directions(random_places(6, dice), RigidMotion::plate);
  const Eigen::MatrixXd truth = sensors * known_mass().inverse() * actuators.transpose();
  const Eigen::MatrixXd blend = dice.normal(3, 3);  // of L and R, as any fit may leave it
  const Eigen::MatrixXd left = sensors * blend;
  const Eigen::MatrixXd right = blend.inverse() * known_mass().inverse() * actuators.transpose();
  const auto body = rigid_body(left * right, {}, sensors, actuators);
  EXPECT_LT((body.mass - known_mass()).norm(), 1e-10 * known_mass().norm());
  EXPECT_LT(body.asymmetry, 1e-12);
  EXPECT_LT((body.modes.transpose() * body.mass * body.modes - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
  const Eigen::MatrixXd rows = (sensors * body.modes) * (actuators * body.modes).transpose();
  EXPECT_LT((rows - truth).norm(), 1e-11 * truth.norm());
  // The first mode is the translation: the same at every place.
  const Eigen::VectorXd first = (sensors * body.modes).col(0);
  EXPECT_LT((first.array() - 1.0 / std::sqrt(19.4)).abs().maxCoeff(), 1e-12);
}

// Thesis (5.6) to (5.9): a point mass of 1 kg, its modes blended as in the numerical example.
TEST(RigidBody, UndoesTheBlendOfThePointMass) {
  // det(I − R₁(γ)) = 1 − 3/2 γ² = 0.
  const double gamma = std::sqrt(2.0 / 3.0);
  const Eigen::Vector2d left_1(0.5 * gamma, gamma);
  const Eigen::RowVector2d right_1(gamma, gamma);
  const Eigen::Matrix2d first = left_1 * right_1;
  EXPECT_LT((first - Eigen::Matrix2d{{1.0 / 3.0, 1.0 / 3.0}, {2.0 / 3.0, 2.0 / 3.0}}).norm(),
            1e-15);
  const Eigen::Matrix2d second = Eigen::Matrix2d::Identity() - first;
  EXPECT_NEAR(second.determinant(), 0.0, 1e-15);
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(second, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector2d left_2 = svd.matrixU().col(0) * svd.singularValues()(0);
  const Eigen::Vector2d right_2 = svd.matrixV().col(0);
  EXPECT_LT((left_2 * right_2.transpose() -
             Eigen::Matrix2d{{2.0 / 3.0, -1.0 / 3.0}, {-2.0 / 3.0, 1.0 / 3.0}})
                .norm(),
            1e-15);
  // Both places are collocated, and yet the two sides of each mode differ (effect 2):
  EXPECT_LT(modal::mac(Eigen::MatrixXd(left_1), Eigen::MatrixXd(right_1.transpose()))(0, 0), 0.95);
  EXPECT_LT(modal::mac(Eigen::MatrixXd(left_2), Eigen::MatrixXd(right_2))(0, 0), 0.95);
  // The product holds none of it.
  const Eigen::MatrixXd product = first + left_2 * right_2.transpose();
  const Eigen::MatrixXd directions = Eigen::Matrix2d::Identity();
  const auto body = rigid_body(product, {}, directions, directions);
  EXPECT_LT((body.mass - Eigen::Matrix2d::Identity()).norm(), 1e-14);
  EXPECT_LT((body.modes * body.modes.transpose() - Eigen::Matrix2d::Identity()).norm(), 1e-14);
}

// Appendix C: any α₁ in [0, 1] gives vectors of the same matrix; all of them one mass matrix.
TEST(RigidBody, IsBlindToTheFreedomOfAppendixC) {
  const Eigen::Vector2d phi_1(1.0, 2.0);
  const Eigen::Vector2d phi_2(-1.0, 4.0);
  const Eigen::Matrix2d rigid = phi_1 * phi_1.transpose() + phi_2 * phi_2.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(rigid);
  const Eigen::Matrix2d u = solver.eigenvectors() * solver.eigenvalues().cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd directions{{1.0, -0.1}, {1.0, 0.2}};
  for (const double alpha : {0.0, 0.3, 0.8, 1.0}) {
    const double other = std::sqrt(1.0 - alpha * alpha);
    const Eigen::Vector2d one = alpha * u.col(0) + other * u.col(1);
    const Eigen::Vector2d two = other * u.col(0) - alpha * u.col(1);
    const Eigen::Matrix2d sum = one * one.transpose() + two * two.transpose();
    const auto body = rigid_body(sum, {}, directions, directions);
    const Eigen::MatrixXd shapes = directions * body.modes;
    EXPECT_LT((shapes * shapes.transpose() - rigid).norm(), 1e-12 * rigid.norm()) << alpha;
    // One of the solutions is a true translation, here the first: equal at both places.
    EXPECT_NEAR(shapes(0, 0), shapes(1, 0), 1e-12);
  }
}

TEST(RigidBody, StatesItsDeviations) {
  simulators::Dice dice(8);
  const auto sensors = rigid_directions(random_places(4, dice), RigidMotion::plate);
  const auto actuators = rigid_directions(random_places(5, dice), RigidMotion::plate);
  const Eigen::MatrixXd truth = sensors * known_mass().inverse() * actuators.transpose();
  const Eigen::MatrixXd deviation = 1e-3 * truth.cwiseAbs() + Eigen::MatrixXd::Constant(4, 5, 1e-5);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(3, 3);
  double misfit = 0.0;
  constexpr int kDraws = 400;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::MatrixXd seen = truth + deviation.cwiseProduct(dice.normal(4, 5));
    const auto body = rigid_body(seen, deviation, sensors, actuators);
    square += (body.mass - known_mass()).cwiseAbs2() / kDraws;
    misfit += body.misfit / kDraws;
  }
  const auto stated = rigid_body(truth, deviation, sensors, actuators);
  EXPECT_NEAR(misfit, 1.0, 4.0 * std::sqrt(2.0 / 14.0 / kDraws));
  const Eigen::MatrixXd ratio = square.cwiseSqrt().cwiseQuotient(stated.mass_std);
  EXPECT_LT((ratio.array() - 1.0).abs().maxCoeff(), 4.0 / std::sqrt(2.0 * kDraws));
}

TEST(RigidBody, FollowsTheUnitOfLength) {
  simulators::Dice dice(4);
  const auto places = random_places(5, dice);
  const Eigen::MatrixXd p = rigid_directions(places, RigidMotion::plate);
  const Eigen::MatrixXd q = rigid_directions(1e6 * places, RigidMotion::plate);
  const Eigen::MatrixXd product = p * known_mass().inverse() * p.transpose();
  const auto metres = rigid_body(product, {}, p, p);
  const auto micrometres = rigid_body(product, {}, q, q);
  const Eigen::Vector3d unit(1.0, 1e6, 1e6);
  const Eigen::MatrixXd wanted = unit.asDiagonal() * metres.mass * unit.asDiagonal();
  EXPECT_LT((micrometres.mass - wanted).norm(), 1e-9 * wanted.norm());
}

TEST(RigidBody, NoticesATurnedChannelAndTooFewPlaces) {
  simulators::Dice dice(5);
  const auto places = random_places(4, dice);
  const Eigen::MatrixXd p = rigid_directions(places, RigidMotion::plate);
  Eigen::MatrixXd product = p * known_mass().inverse() * p.transpose();
  const Eigen::MatrixXd deviation = Eigen::MatrixXd::Constant(4, 4, 1e-4);
  EXPECT_LT(rigid_body(product, deviation, p, p).misfit, 1e-9);
  EXPECT_THROW((void)rigid_body(-product, deviation, p, p), NumericalFailure);
  product.row(2) *= -1.0;
  double misfit = 1e9;
  try {
    misfit = rigid_body(product, deviation, p, p).misfit;
  } catch (const NumericalFailure&) {
  }
  EXPECT_GT(misfit, 100.0);
  const Eigen::MatrixXd two = p.topRows(2);
  EXPECT_THROW((void)rigid_body(product.topRows(2), {}, two, p), NumericalFailure);
  EXPECT_THROW((void)rigid_body(product, deviation, two, p), InvalidInput);
  EXPECT_THROW((void)rigid_body(product, 0.0 * deviation, p, p), InvalidInput);
}

}  // namespace
}  // namespace chladni::identification
