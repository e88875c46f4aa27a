#include "fem/material.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"

namespace chladni::fem {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

Material silicon() { return cubic(165.7e9, 63.9e9, 79.6e9, 2329.0); }

Material spruce() {
  Orthotropic constants;
  constants.youngs_modulus << 10.8e9, 0.84e9, 0.46e9;
  constants.poissons_ratio << 0.435, 0.467, 0.372;
  constants.shear_modulus << 0.032e9, 0.69e9, 0.77e9;
  return orthotropic(constants, 400.0);
}

// Young's modulus along body axis i.
double modulus_along(const Material& material, int i) {
  return 1.0 / material.stiffness.inverse()(i, i);
}

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

// Columns are the crystal's axes in the body; `direction` of the crystal lies along x.
Eigen::Matrix3d with_along_x(const Eigen::Vector3d& direction) {
  return Eigen::Quaterniond::FromTwoVectors(direction, Eigen::Vector3d::UnitX()).toRotationMatrix();
}

TEST(Material, IsotropicGivesBackItsConstants) {
  const auto material = isotropic(70e9, 0.33, 2700.0);
  const Matrix6 compliance = material.stiffness.inverse();
  EXPECT_NEAR(1.0 / compliance(1, 1), 70e9, 1.0);
  EXPECT_NEAR(-compliance(0, 2) / compliance(0, 0), 0.33, 1e-12);
  EXPECT_NEAR(1.0 / compliance(4, 4), 70e9 / 2.66, 1.0);
  EXPECT_EQ(material.density, 2700.0);
}

TEST(Material, IsotropicIsBlindToItsAxes) {
  const auto material = isotropic(210e9, 0.3, 7850.0);
  const auto seen = turned(material, about({1.0, -2.0, 0.5}, 0.7));
  EXPECT_TRUE(seen.stiffness.isApprox(material.stiffness, 1e-13));
}

TEST(Material, CubicIsBlindToAQuarterTurn) {
  EXPECT_TRUE(turned(silicon(), about({0.0, 0.0, 1.0}, 2.0 * std::atan(1.0)))
                  .stiffness.isApprox(silicon().stiffness, 1e-13));
}

TEST(Material, CubicWithZenerRatioOneIsIsotropic) {
  const auto steel = isotropic(210e9, 0.3, 7850.0);
  const double c11 = steel.stiffness(0, 0);
  const double c12 = steel.stiffness(0, 1);
  EXPECT_TRUE(
      cubic(c11, c12, 0.5 * (c11 - c12), 7850.0).stiffness.isApprox(steel.stiffness, 1e-13));
}

// Hopcroft, Nix and Kenny, What is the Young's modulus of silicon?, JMEMS 19(2), 2010: 130, 169 and
// 188 GPa along [100], [110] and [111].
TEST(Material, SiliconHasThePublishedYoungsModuli) {
  EXPECT_NEAR(modulus_along(silicon(), 0), 130.1e9, 0.1e9);
  EXPECT_NEAR(modulus_along(turned(silicon(), with_along_x({1.0, 1.0, 0.0})), 0), 169.1e9, 0.2e9);
  EXPECT_NEAR(modulus_along(turned(silicon(), with_along_x({1.0, 1.0, 1.0})), 0), 187.8e9, 0.2e9);
}

// 1/E = s11 − 2 (s11 − s12 − s44/2) (l²m² + m²n² + n²l²)  (Nye 1957, chapter VIII).
TEST(Material, CubicYoungsModulusFollowsNyesFormulaInAnyDirection) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const Matrix6 s = silicon().stiffness.inverse();
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d d =
        Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Eigen::Vector3d q = d.cwiseAbs2();
    const double mixed = q(0) * q(1) + q(1) * q(2) + q(2) * q(0);
    const double expected = 1.0 / (s(0, 0) - 2.0 * (s(0, 0) - s(0, 1) - 0.5 * s(3, 3)) * mixed);
    EXPECT_NEAR(modulus_along(turned(silicon(), with_along_x(d)), 0), expected, 1e-9 * expected);
  }
}

TEST(Material, OrthotropicGivesBackItsConstants) {
  const Matrix6 s = spruce().stiffness.inverse();
  EXPECT_NEAR(1.0 / s(0, 0), 10.8e9, 1.0);
  EXPECT_NEAR(1.0 / s(2, 2), 0.46e9, 1.0);
  EXPECT_NEAR(-s(1, 0) / s(0, 0), 0.372, 1e-12);
  EXPECT_NEAR(-s(2, 0) / s(0, 0), 0.467, 1e-12);
  EXPECT_NEAR(-s(2, 1) / s(1, 1), 0.435, 1e-12);
  EXPECT_NEAR(1.0 / s(3, 3), 0.032e9, 1.0);
  EXPECT_NEAR(1.0 / s(4, 4), 0.69e9, 1.0);
  EXPECT_NEAR(1.0 / s(5, 5), 0.77e9, 1.0);
}

TEST(Material, OrthotropicWithEqualConstantsIsIsotropic) {
  Orthotropic constants;
  constants.youngs_modulus.setConstant(70e9);
  constants.poissons_ratio.setConstant(0.33);
  constants.shear_modulus.setConstant(70e9 / 2.66);
  EXPECT_TRUE(orthotropic(constants, 2700.0)
                  .stiffness.isApprox(isotropic(70e9, 0.33, 2700.0).stiffness, 1e-13));
}

TEST(Material, TurnsThereAndBack) {
  const auto axes = about({0.3, 1.0, -0.4}, 1.1);
  const auto back = turned(turned(spruce(), axes), axes.transpose());
  EXPECT_TRUE(back.stiffness.isApprox(spruce().stiffness, 1e-12));
}

TEST(Material, TurnsAddUp) {
  const auto a = about({1.0, 0.2, 0.0}, 0.4);
  const auto b = about({0.0, 1.0, 2.0}, -0.9);
  EXPECT_TRUE(
      turned(turned(spruce(), a), b).stiffness.isApprox(turned(spruce(), b * a).stiffness, 1e-12));
}

// The energy of a strain does not depend on who looks at it.
TEST(Material, TurnedKeepsTheEnergyOfATurnedStrain) {
  const auto axes = about({-1.0, 0.5, 0.8}, 0.6);
  Eigen::Matrix3d strain;
  strain << 1.0, 0.3, -0.2, 0.3, -0.5, 0.7, -0.2, 0.7, 0.4;
  const auto voigt = [](const Eigen::Matrix3d& e) {
    Eigen::Matrix<double, 6, 1> v;
    v << e(0, 0), e(1, 1), e(2, 2), 2.0 * e(1, 2), 2.0 * e(0, 2), 2.0 * e(0, 1);
    return v;
  };
  const auto in_material = voigt(strain);
  const auto in_body = voigt(axes * strain * axes.transpose());
  const double energy = in_material.dot(spruce().stiffness * in_material);
  EXPECT_NEAR(in_body.dot(turned(spruce(), axes).stiffness * in_body), energy, 1e-12 * energy);
}

TEST(Material, TurningMovesTheStiffAxisWhereItIsSent) {
  // The grain (axis 1) is sent along y.
  EXPECT_NEAR(modulus_along(turned(spruce(), about({0.0, 0.0, 1.0}, 2.0 * std::atan(1.0))), 1),
              10.8e9, 10.0);
}

TEST(Material, RefusesWhatNoMaterialHas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)isotropic(0.0, 0.3, 1.0), InvalidInput);
  EXPECT_THROW((void)isotropic(nan, 0.3, 1.0), InvalidInput);
  EXPECT_THROW((void)isotropic(1e9, 0.5, 1.0), InvalidInput);
  EXPECT_THROW((void)isotropic(1e9, -1.0, 1.0), InvalidInput);
  EXPECT_THROW((void)isotropic(1e9, nan, 1.0), InvalidInput);
  EXPECT_THROW((void)isotropic(1e9, 0.3, -1.0), InvalidInput);
  EXPECT_THROW((void)isotropic(1e9, 0.3, std::numeric_limits<double>::infinity()), InvalidInput);
  EXPECT_THROW((void)cubic(1e9, 1e9, 1e9, 1.0), InvalidInput);
  EXPECT_THROW((void)cubic(1e9, -0.6e9, 1e9, 1.0), InvalidInput);
  EXPECT_THROW((void)cubic(1e9, 0.5e9, 0.0, 1.0), InvalidInput);
  EXPECT_THROW((void)turned(silicon(), 2.0 * Eigen::Matrix3d::Identity()), InvalidInput);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(0, 0) = -1.0;
  EXPECT_THROW((void)turned(silicon(), mirror), InvalidInput);
}

TEST(Material, NamesTheEigenvalueThatIsNotPositive) {
  Orthotropic constants;
  constants.youngs_modulus << 10.8e9, 0.84e9, 0.46e9;
  constants.poissons_ratio << 0.435, 0.467, 4.0;
  constants.shear_modulus.setConstant(1e9);
  try {
    (void)orthotropic(constants, 400.0);
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("eigenvalue -"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace chladni::fem
