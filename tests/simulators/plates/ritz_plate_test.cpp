#include "simulators/plates/ritz_plate.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "simulators/plates/gauss_rule.h"
#include "simulators/plates/kirchhoff_plate.h"

namespace chladni::simulators {
namespace {

using std::numbers::pi;

RitzBody thin_square(double thickness, int degree) {
  RitzBody body;
  body.length = body.width = 1.0;
  body.stiffness = isotropic_plane(70e9, 0.3);
  body.density = 2700.0;
  body.thickness = Eigen::MatrixXd::Constant(1, 1, thickness);
  body.degree = degree;
  return body;
}

// Leissa (1969), as computed to five digits for ν = 0.3: ω a² √(ρh/D).
TEST(RitzPlate, TendsToTheThinFreeSquarePlate) {
  const auto body = thin_square(1e-3, 12);
  const double d = body.stiffness.q11 * 1e-9 / 12.0;
  const Eigen::VectorXd hz = ritz_modes(body).frequency_hz;
  const double known[] = {13.468, 19.596, 24.270, 34.801, 34.801, 61.093, 61.093, 63.686, 69.265};
  EXPECT_EQ(hz.head(3).norm(), 0.0);
  for (Eigen::Index i = 0; i < 9; ++i) {
    const double number = 2.0 * pi * hz(3 + i) * std::sqrt(2.7 / d);
    EXPECT_NEAR(number, known[i], 1e-4 * known[i]) << i;
  }
}

// The frequencies of the table by three-dimensional elasticity, from models/oat/minimal.
TEST(RitzPlate, ShearsAsAThickPlateDoes) {
  const double solid[] = {178.9033, 264.0703, 334.3557, 463.3912, 463.3912,
                          828.3701, 828.3701, 841.9149, 917.1476, 1037.6694};
  const Eigen::VectorXd hz = ritz_modes(aluminium_table(16)).frequency_hz;
  for (Eigen::Index i = 0; i < 10; ++i) EXPECT_NEAR(hz(3 + i), solid[i], 6e-4 * solid[i]) << i;
}

// Convergence is slow because of a layer along the free rim, as thin as the plate: a factor of
// about 4 per step of 4 degrees.
TEST(RitzPlate, ConvergesFromAbove) {
  const Eigen::VectorXd coarse = ritz_modes(aluminium_table(8)).frequency_hz;
  const Eigen::VectorXd middle = ritz_modes(aluminium_table(10)).frequency_hz;
  const Eigen::VectorXd fine = ritz_modes(aluminium_table(12)).frequency_hz;
  for (Eigen::Index i = 3; i < 12; ++i) {
    EXPECT_GT(middle(i), fine(i)) << i;
    EXPECT_GT(coarse(i) - middle(i), 1.4 * (middle(i) - fine(i))) << i;
    EXPECT_LT(middle(i) - fine(i), 2e-3 * fine(i)) << i;
  }
}

// Orthotropy and a taper, compared with elements that share no code with the plate.
TEST(RitzPlate, AgreesWithThinElementsWhereTheyAreExact) {
  auto body = thin_square(2e-3, 10);
  body.width = 0.7;
  body.stiffness.q11 *= 1.6;
  body.stiffness.q66 *= 0.8;
  body.thickness = Eigen::MatrixXd::Zero(2, 1);
  body.thickness << 2e-3, 0.4e-3;  // 2 mm + 0.4 mm · 2x / length
  const PlateGrid grid{1.0, 0.7, 40, 20};
  auto plate = uniform_plate(grid, {1.0, 1.0, 1.0, 1.0}, 1.0);
  for (Eigen::Index c = 0; c < grid.cell_count(); ++c) {
    const double t = 2e-3 + 0.4e-3 * 2.0 * grid.centre(c).x();
    const double t3 = t * t * t / 12.0;
    const auto& q = body.stiffness;
    plate.bending[static_cast<std::size_t>(c)] = {q.q11 * t3, q.q12 * t3, q.q22 * t3, q.q66 * t3};
    plate.areal_mass(c) = 2700.0 * t;
  }
  const Eigen::VectorXd hz = ritz_modes(body).frequency_hz;
  const Eigen::VectorXd other = plate_modes(plate, 8).frequency_hz;
  for (Eigen::Index i = 3; i < 11; ++i) EXPECT_NEAR(hz(i), other(i), 3e-4 * other(i)) << i;
}

TEST(RitzPlate, HasThePlatesMassAndRigidMotions) {
  auto body = aluminium_table(6);
  body.thickness = Eigen::MatrixXd::Zero(2, 2);
  body.thickness << 0.02, 0.003, -0.001, 0.002;
  const auto matrices = ritz_matrices(body);
  const Eigen::Index m = 49;
  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(3 * m, 3);
  rigid(0, 0) = 1.0;                   // w = 1
  rigid(7, 1) = 0.3 / std::sqrt(3.0);  // w = x
  rigid(m, 1) = -1.0;                  // ψx = −1
  rigid(1, 2) = 0.3 / std::sqrt(3.0);  // w = y
  rigid(2 * m, 2) = -1.0;
  EXPECT_LT((matrices.stiffness * rigid).norm(), 1e-9 * matrices.stiffness.norm());
  const Eigen::Matrix3d mass = rigid.transpose() * matrices.mass * rigid;
  EXPECT_NEAR(mass(0, 0), 19.44, 1e-9);
  EXPECT_NEAR(mass(0, 1), 2700.0 * -0.001 * 0.36 * 0.1, 1e-12);  // ∫ ρ t x
}

TEST(RitzPlate, NormalisesItsModes) {
  const auto modes = ritz_modes(aluminium_table(6));
  const auto matrices = ritz_matrices(modes.body);
  const Eigen::MatrixXd one = modes.coefficients.transpose() * matrices.mass * modes.coefficients;
  EXPECT_TRUE(one.isIdentity(1e-9));
}

TEST(RitzPlate, ScalesAsItsPhysics) {
  const auto base = ritz_modes(aluminium_table(6)).frequency_hz;
  auto heavy = aluminium_table(6);
  heavy.density *= 1.21;
  EXPECT_LT((1.1 * ritz_modes(heavy).frequency_hz - base).head(20).norm(), 1e-6);
  auto all = aluminium_table(6);
  all.discs = {{{0.1, -0.05}, 2.0, 1.44, 1.0}};  // it covers the plate
  EXPECT_LT((ritz_modes(all).frequency_hz / 1.2 - base).head(20).norm(),
            1e-5 * base.head(20).norm());
  auto turned = aluminium_table(6);
  turned.stiffness.q11 *= 1.3;
  auto other = aluminium_table(6);
  other.stiffness.q22 *= 1.3;
  EXPECT_LT((ritz_modes(turned).frequency_hz - ritz_modes(other).frequency_hz).head(20).norm(),
            1e-6);
}

// dλ = φᵀ dK φ, with an integral of the curvatures that this test computes itself.
TEST(RitzPlate, DiscsSoftenWhereThePlateBends) {
  const auto modes = ritz_modes(aluminium_table(10));
  auto softer = modes.body;
  softer.discs = {{{0.08, 0.13}, 0.04, 0.999, 1.0}};
  const Eigen::VectorXd change =
      ritz_modes(softer).frequency_hz.cwiseAbs2() - modes.frequency_hz.cwiseAbs2();
  const Eigen::Index k = 3;
  constexpr double kStep = 2e-3;
  Eigen::MatrixX2d star(9, 2);
  star << 0, 0, 1, 0, -1, 0, 0, 1, 0, -1, 1, 1, -1, -1, 1, -1, -1, 1;
  star = (star * kStep).rowwise() + Eigen::RowVector2d(0.08, 0.13);
  const Eigen::VectorXd w = modal_rows(modes, star).deflection.col(k);
  const double xx = (w(1) + w(2) - 2.0 * w(0)) / (kStep * kStep);
  const double yy = (w(3) + w(4) - 2.0 * w(0)) / (kStep * kStep);
  const double xy = (w(5) + w(6) - w(7) - w(8)) / (4.0 * kStep * kStep);
  const auto& q = modes.body.stiffness;
  const double energy =
      (q.q11 * xx * xx + q.q22 * yy * yy + 2.0 * q.q12 * xx * yy + 4.0 * q.q66 * xy * xy) * 8e-6 /
      12.0;
  const double expected = -1e-3 * energy * pi * 0.04 * 0.04 / (4.0 * pi * pi);
  EXPECT_NEAR(change(k), expected, 0.08 * std::abs(expected));
}

// The first mode of a free beam has 2.522 times its mean square curvature in the middle. A released
// moment costs (1 - ν²) of a beam's energy. A crack along the beam has almost no effect.
TEST(RitzPlate, CracksLetGoAcrossThemselves) {
  RitzBody strip = thin_square(0.01, 10);
  strip.width = 0.05;
  const double whole = ritz_modes(strip).frequency_hz(3);
  auto along = strip;
  along.cracks = {{{-0.1, 0.0}, {0.1, 0.0}, 4e-3, 0.1}};
  auto across = strip;
  across.cracks = {{{0.0, -0.025}, {0.0, 0.025}, 4e-3, 0.1}};
  const double expected = 0.5 * 0.1 * (1.0 - 0.09) * 4e-3 * 2.522;
  EXPECT_NEAR(1.0 - ritz_modes(across).frequency_hz(3) / whole, expected, 0.1 * expected);
  EXPECT_LT(1.0 - ritz_modes(along).frequency_hz(3) / whole, 0.02 * expected);
  across.cracks.front().loss = 0.0;
  EXPECT_NEAR(ritz_modes(across).frequency_hz(3), whole, 1e-9 * whole);
}

TEST(RitzPlate, CellsAndPartsSumToTheWhole) {
  auto body = aluminium_table(6);
  body.stiffness.q11 *= 1.2;
  body.thickness = Eigen::MatrixXd::Zero(1, 2);
  body.thickness << 0.02, 0.002;
  const auto modes = ritz_modes(body);
  constexpr Eigen::Index kCount = 20;
  RitzMatrices cells{Eigen::MatrixXd::Zero(kCount, kCount), Eigen::MatrixXd::Zero(kCount, kCount)};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) {
      const Eigen::Vector2d low(-0.3 + 0.2 * i, -0.3 + 0.3 * j);
      const auto cell = modal_cell(modes, kCount, low, low + Eigen::Vector2d(0.2, 0.3));
      cells.stiffness += cell.stiffness;
      cells.mass += cell.mass;
    }
  }
  const Eigen::MatrixXd lambda =
      (2.0 * pi * modes.frequency_hz.head(kCount)).cwiseAbs2().asDiagonal();
  EXPECT_LT((cells.stiffness - lambda).norm(), 1e-9 * lambda.norm());
  EXPECT_TRUE(cells.mass.isIdentity(1e-9));
  const Eigen::Vector2d half(0.3, 0.3);
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(kCount, kCount);
  for (const auto part : {StiffnessPart::along_x, StiffnessPart::along_y, StiffnessPart::across,
                          StiffnessPart::shear}) {
    parts += modal_cell(modes, kCount, -half, half, part).stiffness;
  }
  EXPECT_LT((parts - lambda).norm(), 1e-9 * lambda.norm());
}

// A modulus that rises along x, compared with elements that share no code with the plate.
TEST(RitzPlate, AModulusMayVary) {
  auto body = thin_square(2e-3, 10);
  const PlateGrid grid{1.0, 1.0, 32, 32};
  auto plate = uniform_plate(grid, {1.0, 1.0, 1.0, 1.0}, 2700.0 * 2e-3);
  for (Eigen::Index c = 0; c < grid.cell_count(); ++c) {
    const double by = (1.0 + 0.3 * 2.0 * grid.centre(c).x()) * 8e-9 / 12.0;
    const auto& q = body.stiffness;
    plate.bending[static_cast<std::size_t>(c)] = {q.q11 * by, q.q12 * by, q.q22 * by, q.q66 * by};
  }
  body.modulus = Eigen::MatrixXd::Zero(2, 1);
  body.modulus << 1.0, 0.3;
  const Eigen::VectorXd hz = ritz_modes(body).frequency_hz;
  const Eigen::VectorXd other = plate_modes(plate, 8).frequency_hz;
  for (Eigen::Index i = 3; i < 11; ++i) EXPECT_NEAR(hz(i), other(i), 5e-4 * other(i)) << i;
  body.modulus = Eigen::MatrixXd::Constant(1, 1, 1.21);
  const Eigen::VectorXd stiff = ritz_modes(body).frequency_hz;
  const Eigen::VectorXd even = ritz_modes(thin_square(2e-3, 10)).frequency_hz;
  EXPECT_LT((stiff - 1.1 * even).head(40).norm(), 1e-6 * even.head(40).norm());
}

RitzBody steel_strip(int degree) {
  RitzBody body;
  body.length = 0.5;
  body.width = 0.02;
  body.stiffness = isotropic_plane(210e9, 0.3);
  body.density = 7850.0;
  body.thickness = Eigen::MatrixXd::Constant(1, 1, 2e-3);
  body.degree = degree;
  body.degree_across = 5;
  return body;
}

// Euler-Bernoulli: a strip that is narrow compared with its waves bends with E, not with
// E/(1 - ν²).
TEST(RitzPlate, AStripBendsAsABeam) {
  const Eigen::VectorXd hz = ritz_modes(steel_strip(20)).frequency_hz;
  const double root = std::sqrt(210e9 * 4e-6 / 12.0 / 7850.0) / (2.0 * pi * 0.25);
  const double known[] = {4.730041, 7.853205, 10.995608};
  for (int i = 0; i < 3; ++i) {
    const double beam = known[i] * known[i] * root;
    EXPECT_NEAR(hz(3 + i), beam, 4e-3 * beam) << i;
  }
}

// models/beam: 0.157 kg on 19.586 N/m and 0.50404 N m/rad at each end gives 2.5 and 5 Hz.
TEST(RitzPlate, AStripSwaysAndTurnsOnItsFlexures) {
  auto body = steel_strip(20);
  for (const double x : {-0.24, 0.24}) {
    RitzFixture one;
    one.place = {x, 0.0};
    one.footprint = 6e-3;
    one.stiffness = 19.586;
    one.turning_x = 0.50404;
    one.turning_y = 20.0;
    body.fixtures.push_back(one);
  }
  const Eigen::VectorXd hz = ritz_modes(body).frequency_hz;
  EXPECT_EQ(body.rigid_count(), 0);
  EXPECT_NEAR(hz(0), 2.5, 2.5e-3);
  EXPECT_NEAR(hz(1), 5.0, 5e-3);
  body.fixtures.front().turning_y = body.fixtures.back().turning_y = 0.0;
  EXPECT_THROW((void)ritz_modes(body), InvalidInput);  // it rolls
}

TEST(RitzPlate, SlopesAreDerivatives) {
  const auto body = aluminium_table(9);
  constexpr double kStep = 1e-6;
  Eigen::MatrixX2d star(5, 2);
  star << 0.21, -0.13, 0.21 + kStep, -0.13, 0.21 - kStep, -0.13, 0.21, -0.13 + kStep, 0.21,
      -0.13 - kStep;
  const auto rows = ritz_rows(body, star);
  const Eigen::RowVectorXd x = (rows.deflection.row(1) - rows.deflection.row(2)) / (2.0 * kStep);
  const Eigen::RowVectorXd y = (rows.deflection.row(3) - rows.deflection.row(4)) / (2.0 * kStep);
  EXPECT_LT((x - rows.slope_x.row(0)).norm(), 1e-6 * x.norm());
  EXPECT_LT((y - rows.slope_y.row(0)).norm(), 1e-6 * y.norm());
}

TEST(RitzPlate, MovesAtOnePlaceAsAmongMany) {
  const auto modes = ritz_modes(aluminium_table(6));
  Eigen::MatrixX2d places(3, 2);
  places << 0.11, -0.07, -0.3, 0.02, 0.0, 0.1;
  const auto rows = modal_rows(modes, places);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    const auto at = deflection_at(modes, places.row(i).transpose());
    ASSERT_EQ(at.rows(), modes.mode_count());
    EXPECT_LT((at.col(0).transpose() - rows.deflection.row(i)).norm(), 1e-12 * at.col(0).norm());
    EXPECT_LT((at.col(1).transpose() - rows.slope_x.row(i)).norm(), 1e-12 * at.col(1).norm());
    EXPECT_LT((at.col(2).transpose() - rows.slope_y.row(i)).norm(), 1e-12 * at.col(2).norm());
  }
}

TEST(RitzPlate, SaysWhatIsWrong) {
  auto body = aluminium_table(4);
  EXPECT_THROW((void)ritz_rows(body, Eigen::RowVector2d(0.301, 0.0)), InvalidInput);
  body.discs = {{{0.4, 0.0}, 0.1, 0.5, 1.0}};
  EXPECT_THROW((void)ritz_modes(body), InvalidInput);
  body.discs.clear();
  body.thickness = Eigen::MatrixXd::Zero(2, 1);
  body.thickness << 0.02, 0.03;
  EXPECT_THROW((void)ritz_modes(body), InvalidInput);
}

TEST(GaussRule, IntegratesDiscsThatTheRimCuts) {
  const Eigen::Vector2d half(0.3, 0.2);
  EXPECT_NEAR(disc_rule({0.0, 0.0}, 0.1, half, 6).area.sum(), pi * 0.01, 1e-12);
  EXPECT_NEAR(disc_rule({0.3, 0.0}, 0.1, half, 12).area.sum(), 0.5 * pi * 0.01, 1e-10);
  EXPECT_NEAR(disc_rule({0.3, 0.2}, 0.1, half, 12).area.sum(), 0.25 * pi * 0.01, 1e-10);
  EXPECT_NEAR(disc_rule({0.1, 0.1}, 2.0, half, 12).area.sum(), 0.24, 1e-6);
  const double segment = 0.01 * std::acos(0.5) - 0.05 * std::sqrt(0.01 - 0.0025);
  EXPECT_NEAR(disc_rule({0.25, 0.0}, 0.1, half, 14).area.sum(), pi * 0.01 - segment, 1e-9);
  const auto band = band_rule({0.0, 0.0}, {0.03, 0.04}, 0.01, 3, 2);
  EXPECT_NEAR(band.area.sum(), 5e-4, 1e-15);
}

}  // namespace
}  // namespace chladni::simulators
