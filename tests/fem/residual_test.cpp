#include "fem/eigen/residual.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"

namespace chladni::fem {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// ---- What the residual sees.

class ResidualOfAPlate : public ::testing::Test {
 protected:
  // Residuals of the flexible modes with one of them changed.
  [[nodiscard]] Eigen::VectorXd with(const Eigen::VectorXd& lambda,
                                     const Eigen::MatrixXd& shapes) const {
    return residuals(system_, factor_, s_, system_.rigid, lambda, shapes);
  }

  System system_ =
      assemble(mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, 0.05, 1), 2),
               {isotropic(70e9, 0.33, 2700.0)});
  ModesResult found_ = modes(system_, {.count = 6});
  Eigen::MatrixXd shapes_ = found_.modes.shapes.rightCols(6);
  Eigen::VectorXd lambda_ = (kTurn * found_.modes.frequency_hz.tail(6)).array().square();
  double s_ = lambda_(0);
  Symbolic symbolic_{system_.stiffness};
  Factorization factor_{symbolic_, system_.stiffness, s_, system_.mass};
};

TEST_F(ResidualOfAPlate, IsSmall) {
  EXPECT_LT(with(lambda_, shapes_).maxCoeff(), 1e-8);
  EXPECT_LT(found_.summary.residual.maxCoeff(), 1e-8);
}

TEST_F(ResidualOfAPlate, AWrongFrequencyIsItsError) {
  for (const double wrong : {1e-3, 1e-6}) {
    Eigen::VectorXd lambda = lambda_;
    lambda(2) *= 1.0 + wrong;
    const auto seen = with(lambda, shapes_);
    EXPECT_NEAR(seen(2) / wrong, 1.0, 0.01);
    EXPECT_LT(seen(1), 1e-8);
  }
}

// A shape mixed with another mode, which the backward error ‖r‖ / (‖K‖ ‖φ‖) cannot see.
TEST_F(ResidualOfAPlate, AMixedShapeIsSeen) {
  for (const double wrong : {1e-3, 1e-6}) {
    Eigen::MatrixXd shapes = shapes_;
    shapes.col(0) += wrong * shapes_.col(3);
    EXPECT_GT(with(lambda_, shapes)(0), 0.5 * wrong);
    const Eigen::VectorXd shape = shapes.col(0);
    const Eigen::VectorXd inertia = system_.mass.selfadjointView<Eigen::Lower>() * shape;
    Eigen::VectorXd r = system_.stiffness.selfadjointView<Eigen::Lower>() * shape;
    r -= lambda_(0) * inertia;
    EXPECT_LT(r.norm() / (system_.stiffness.diagonal().maxCoeff() * shapes.col(0).norm()),
              1e-3 * wrong);
  }
}

TEST_F(ResidualOfAPlate, ARoughShapeIsSeen) {
  std::mt19937 generator(7);
  Eigen::VectorXd noise(shapes_.rows());
  for (auto& x : noise) x = static_cast<double>(generator()) / 4294967296.0 - 0.5;
  noise *= shapes_.col(1).norm() / noise.norm();
  for (const double wrong : {1e-3, 1e-6}) {
    Eigen::MatrixXd shapes = shapes_;
    shapes.col(1) += wrong * noise;
    EXPECT_GT(with(lambda_, shapes)(1), 0.3 * wrong);
  }
}

TEST_F(ResidualOfAPlate, WhatIsPolishedComesBack) {
  std::mt19937 generator(8);
  Eigen::MatrixXd shapes = shapes_;
  for (auto& x : shapes.reshaped()) {
    x *= 1.0 + 1e-5 * (static_cast<double>(generator()) / 4294967296.0 - 0.5);
  }
  Eigen::VectorXd lambda = lambda_;
  const double before = with(lambda, shapes).maxCoeff();
  const double after = polished(system_, factor_, s_, system_.rigid, lambda, shapes).maxCoeff();
  EXPECT_GT(before, 1e-6);
  EXPECT_LT(after, 0.1 * before);
  EXPECT_LT((lambda.array() / lambda_.array() - 1.0).abs().maxCoeff(), 1e-9);
}

// ---- Soft suspensions: a rigid body on springs is six numbers in closed form.

constexpr double kLength = 0.1, kWidth = 0.08, kHeight = 0.06, kDensity = 7850.0;

struct Spring {
  Eigen::Vector3d at, direction;
  double stiffness;
};

// Springs at the corners of the top, of unlike stiffness, so that no two modes are alike.
std::vector<Spring> springs(double stiffness) {
  std::vector<Spring> all;
  for (const double x : {-0.03, 0.03}) {
    for (const double y : {-0.02, 0.02}) {
      const Eigen::Vector3d at(x, y, 0.0);
      const double k = stiffness * (1.0 + 5.0 * x + 9.0 * y);
      all.push_back({at, Eigen::Vector3d::UnitZ(), k});
      all.push_back({at, Eigen::Vector3d::UnitX(), 0.6 * k});
      all.push_back({at, Eigen::Vector3d::UnitY(), 0.3 * k});
    }
  }
  return all;
}

Eigen::VectorXd of_a_rigid_block(const std::vector<Spring>& all) {
  const double mass = kDensity * kLength * kWidth * kHeight;
  Eigen::Matrix<double, 6, 1> inertia;
  inertia << mass, mass, mass, mass / 12.0 * (kWidth * kWidth + kHeight * kHeight),
      mass / 12.0 * (kLength * kLength + kHeight * kHeight),
      mass / 12.0 * (kLength * kLength + kWidth * kWidth);
  Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
  for (const auto& spring : all) {
    Eigen::Matrix<double, 6, 1> stretch;
    const Eigen::Vector3d arm = spring.at - Eigen::Vector3d(0.0, 0.0, -0.5 * kHeight);
    stretch << spring.direction, arm.cross(spring.direction);
    stiffness += spring.stiffness * stretch * stretch.transpose();
  }
  const Eigen::Matrix<double, 6, 6> root = inertia.cwiseSqrt().cwiseInverse().asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(root * stiffness * root)
             .eigenvalues()
             .cwiseSqrt() /
         kTurn;
}

class SoftSuspension : public ::testing::TestWithParam<double> {};

System block_on(const std::vector<Spring>& all) {
  const auto body =
      mesh::with_order(mesh::layered(mesh::Plate{kLength, kWidth, kHeight}, 0.02, 3), 2);
  std::vector<Attachment> attachments;
  const mesh::SiteFinder finder(body);
  for (const auto& spring : all) {
    attachments.push_back({"spring", finder.from_above(spring.at.x(), spring.at.y()).value(), 0.0,
                           GroundSpring{spring.direction, spring.stiffness, 0.0}});
  }
  return assemble(body, {isotropic(210e9, 0.3, kDensity)}, {}, attachments);
}

TEST_P(SoftSuspension, HasTheFrequenciesOfARigidBody) {
  const auto all = springs(GetParam());
  const auto system = block_on(all);
  EXPECT_EQ(system.rigid.cols(), 0);
  EXPECT_EQ(system.suspended.cols(), 6);
  const auto [found, summary] = modes(system, {.count = 8});
  const auto expected = of_a_rigid_block(all);
  EXPECT_GT(found.frequency_hz(6), 1e4);
  for (Eigen::Index i = 0; i < 6; ++i) {
    // The block gives way a little where it is held, in proportion to the springs.
    const double give = 1e-9 + 3e-10 * GetParam();
    EXPECT_NEAR(found.frequency_hz(i) / expected(i), 1.0, give) << expected(i) << " Hz";
  }
  // Each of n entries of a shape is rounded by itself; the residual multiplies their sum by
  // λ_bending / λ, which is 7e9 at 0.3 Hz.
  const double stored = 0.5 * std::numeric_limits<double>::epsilon() *
                        std::sqrt(static_cast<double>(system.mass.rows()));
  const auto rounding = [&](Eigen::Index i) {
    return 1e-9 + stored * std::pow(found.frequency_hz(6) / found.frequency_hz(i), 2);
  };
  for (Eigen::Index i = 0; i < 8; ++i) {
    EXPECT_LT(summary.residual(i), rounding(i)) << found.frequency_hz(i) << " Hz";
  }
}

// The first bending mode lies at 23 kHz, the softest of these at 0.3 Hz.
INSTANTIATE_TEST_SUITE_P(Fem, SoftSuspension, ::testing::Values(1e3, 10.0));

// 0.01 Hz against 23 kHz: a factor 10^13 between the stiffnesses.
TEST(SofterThanDigits, IsRefused) {
  EXPECT_THROW((void)modes(block_on(springs(0.01)), {.count = 8}), NumericalFailure);
}

}  // namespace
}  // namespace chladni::fem
