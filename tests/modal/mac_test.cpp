#include "modal/mac.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <limits>
#include <random>

#include "base/error.h"

namespace chladni::modal {
namespace {

Eigen::MatrixXd random_shapes(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST(Mac, OfASetWithItselfHasOnesOnTheDiagonal) {
  const auto a = random_shapes(9, 4, 1);
  EXPECT_TRUE(auto_mac(a).diagonal().isOnes(1e-14));
  EXPECT_TRUE(auto_mac(a).isApprox(auto_mac(a).transpose(), 1e-14));
}

TEST(Mac, OfOrthonormalShapesIsTheIdentity) {
  const Eigen::MatrixXd a = random_shapes(9, 9, 2).householderQr().householderQ();
  EXPECT_TRUE(auto_mac(a).isIdentity(1e-14));
}

TEST(Mac, StaysBetweenZeroAndOne) {
  const auto m = mac(random_shapes(3, 20, 3), random_shapes(3, 30, 4));
  EXPECT_GE(m.minCoeff(), 0.0);
  EXPECT_LE(m.maxCoeff(), 1.0);
}

TEST(Mac, IsBlindToScaleAndSign) {
  const auto a = random_shapes(9, 3, 5);
  const auto b = random_shapes(9, 4, 6);
  const Eigen::MatrixXd scaled = b * Eigen::Vector4d(-2.0, 1e200, 1e-200, 0.1).asDiagonal();
  EXPECT_TRUE(mac(a, scaled).isApprox(mac(a, b), 1e-13));
}

TEST(Mac, OfComplexShapesIsBlindToTheirPhase) {
  const Eigen::MatrixXcd a =
      random_shapes(9, 3, 7) + std::complex<double>(0.0, 1.0) * random_shapes(9, 3, 8);
  const Eigen::MatrixXcd turned = a * std::polar(3.0, 0.7);
  EXPECT_TRUE(mac(a, turned).isApprox(auto_mac(a), 1e-13));
  const Eigen::MatrixXd real = random_shapes(9, 3, 9);
  EXPECT_TRUE(auto_mac(Eigen::MatrixXcd(real)).isApprox(auto_mac(real), 1e-14));
}

TEST(Mac, OfShapesAtFortyFiveDegreesIsOneHalf) {
  EXPECT_NEAR(
      mac(Eigen::MatrixXd(Eigen::Vector2d(1, 0)), Eigen::MatrixXd(Eigen::Vector2d(1, 1)))(0), 0.5,
      1e-15);
}

TEST(SubspaceMac, IsBlindToHowTheBasesAreTurned) {
  const auto a = random_shapes(9, 2, 10);
  Eigen::Matrix2d turn;
  turn << std::cos(0.6), -std::sin(0.6), std::sin(0.6), std::cos(0.6);
  EXPECT_TRUE(subspace_mac(a, a * turn).isOnes(1e-13));
  EXPECT_LT(mac(a, a * turn).diagonal().maxCoeff(), 0.95);
  const auto b = random_shapes(9, 3, 11);
  EXPECT_TRUE(subspace_mac(a * turn, b).isApprox(subspace_mac(a, b), 1e-12));
}

TEST(SubspaceMac, OfSingleShapesIsTheMac) {
  const auto a = random_shapes(9, 1, 12);
  const auto b = random_shapes(9, 1, 13);
  EXPECT_NEAR(subspace_mac(a, b)(0), mac(a, b)(0, 0), 1e-14);
}

TEST(SubspaceMac, GivesTheSquaredCosinesOfKnownAngles) {
  Eigen::MatrixXd a(4, 2);
  a << 1, 0, 0, 1, 0, 0, 0, 0;
  Eigen::MatrixXd b(4, 2);
  b << std::cos(0.3), 0, 0, std::cos(1.1), std::sin(0.3), 0, 0, std::sin(1.1);
  const auto found = subspace_mac(a, b);
  EXPECT_NEAR(found(0), std::pow(std::cos(0.3), 2), 1e-14);
  EXPECT_NEAR(found(1), std::pow(std::cos(1.1), 2), 1e-14);
}

TEST(Comac, FindsThePlaceWhereTwoSetsDisagree) {
  const auto a = random_shapes(9, 5, 14);
  Eigen::MatrixXd b = 2.0 * a;
  b.row(4) = random_shapes(1, 5, 15);
  const auto found = comac(a, b);
  for (Eigen::Index i = 0; i < 9; ++i) {
    if (i != 4) {
      EXPECT_NEAR(found(i), 1.0, 1e-14);
    }
  }
  EXPECT_LT(found(4), 0.9);
}

TEST(Comac, IsBlindToTheSignOfAMode) {
  const auto a = random_shapes(9, 5, 16);
  Eigen::MatrixXd b = a + 0.1 * random_shapes(9, 5, 17);
  const auto before = comac(a, b);
  b.col(2) *= -1.0;
  EXPECT_TRUE(comac(a, b).isApprox(before, 1e-14));
}

TEST(Comac, OfAPlaceThatDoesNotMoveIsOneIfBothAgree) {
  auto a = random_shapes(3, 2, 18);
  auto b = a;
  a.row(0).setZero();
  b.row(0).setZero();
  a.row(1).setZero();
  EXPECT_TRUE(comac(a, b).isApprox(Eigen::Vector3d(1.0, 0.0, 1.0), 1e-14));
}

TEST(Mac, RefusesWhatCannotBeCompared) {
  const auto a = random_shapes(4, 2, 19);
  Eigen::MatrixXd zero = a;
  zero.col(1).setZero();
  Eigen::MatrixXd broken = a;
  broken(0, 0) = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd twice = a;
  twice.col(1) = 3.0 * twice.col(0);
  EXPECT_THROW((void)mac(a, random_shapes(5, 2, 20)), InvalidInput);
  EXPECT_THROW((void)mac(a, zero), InvalidInput);
  EXPECT_THROW((void)mac(broken, a), InvalidInput);
  EXPECT_THROW((void)subspace_mac(a, twice), InvalidInput);
  EXPECT_THROW((void)comac(a, random_shapes(4, 3, 21)), InvalidInput);
  EXPECT_THROW((void)comac(a, broken), InvalidInput);
}

}  // namespace
}  // namespace chladni::modal
