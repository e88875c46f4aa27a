#include "simulators/plates/kirchhoff_plate.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "simulators/portable_random.h"

namespace chladni::simulators {
namespace {

KirchhoffPlate unit_square(int cells) {
  return uniform_plate({1.0, 1.0, cells, cells}, isotropic_bending(1.0, 0.3), 1.0);
}

// w a² √(ρh/D).
Eigen::VectorXd numbers_of(const PlateModes& modes) {
  return 2.0 * std::numbers::pi * modes.frequency_hz;
}

// A plate with all features: orthotropic, uneven, with a cut-out and masses.
KirchhoffPlate uneven(int cells = 12) {
  auto plate = uniform_plate({0.9, 0.6, cells, cells}, {1.0, 0.2, 1.4, 0.5}, 1.0);
  Dice dice(3);
  for (std::size_t c = 0; c < plate.bending.size(); ++c) {
    plate.areal_mass(static_cast<Eigen::Index>(c)) = dice.between(0.5, 2.0);
    plate.bending[c].d11 *= dice.between(0.9, 2.0);
  }
  plate.areal_mass.segment(cells * 5 + 4, 3).setZero();
  plate.masses = {{{0.45, 0.3}, 0.2}, {{-0.11, 0.07}, 0.3}};
  return plate;
}

TEST(KirchhoffPlate, HasTheFrequenciesOfTheFreeSquarePlate) {
  const auto numbers = numbers_of(plate_modes(unit_square(30), 9));
  const double known[] = {13.468, 19.596, 24.270, 34.801, 34.801, 61.093, 61.093, 63.686, 69.265};
  EXPECT_EQ(numbers.head(3).norm(), 0.0);
  for (Eigen::Index i = 0; i < 9; ++i) EXPECT_NEAR(numbers(3 + i), known[i], 1e-3) << i;
}

TEST(KirchhoffPlate, ConvergesFromAboveWithTheFourthPower) {
  const auto coarse = numbers_of(plate_modes(unit_square(6), 6));
  const auto middle = numbers_of(plate_modes(unit_square(12), 6));
  const auto fine = numbers_of(plate_modes(unit_square(24), 6));
  for (Eigen::Index i = 3; i < 9; ++i) {
    EXPECT_GT(coarse(i), middle(i));
    EXPECT_GT(middle(i), fine(i));
    const double order = std::log2((coarse(i) - middle(i)) / (middle(i) - fine(i)));
    EXPECT_GT(order, 3.5) << i;
    EXPECT_LT(order, 4.6) << i;
  }
}

TEST(KirchhoffPlate, HasRigidModesThatAreExactlyPlanes) {
  const auto modes = plate_modes(uneven(), 2);
  const auto surface = plate_surface(modes, 2);
  Eigen::MatrixXd planes(surface.places.rows(), 3);
  planes << Eigen::VectorXd::Ones(planes.rows()), surface.places;
  const Eigen::MatrixXd rigid = shapes_at(modes, surface.places).leftCols(3);
  const Eigen::MatrixXd back =
      planes * (planes.transpose() * planes).ldlt().solve(planes.transpose() * rigid);
  EXPECT_LT((back - rigid).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(modes.frequency_hz.head(3).norm(), 0.0);
}

// ∫ ρh φ φᵀ by a quadrature that is independent of the elements' matrices, plus the point masses.
TEST(KirchhoffPlate, NormalisesShapesToTheMass) {
  const auto plate = uneven(16);
  const auto modes = plate_modes(plate, 5);
  const auto surface = plate_surface(modes, 2);
  const Eigen::MatrixXd shapes = shapes_at(modes, surface.places);
  Eigen::VectorXd mass(surface.area.size());
  Eigen::Index row = 0;
  for (Eigen::Index c = 0; c < plate.grid.cell_count(); ++c) {
    if (plate.areal_mass(c) == 0.0) continue;
    for (int q = 0; q < 4; ++q, ++row) mass(row) = plate.areal_mass(c) * surface.area(row);
  }
  Eigen::MatrixXd gram = shapes.transpose() * mass.asDiagonal() * shapes;
  for (const auto& point : plate.masses) {
    const Eigen::MatrixXd there = shapes_at(modes, point.place.transpose());
    gram += point.kg * there.transpose() * there;
  }
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(8, 8)).cwiseAbs().maxCoeff(), 2e-3);
}

// A strip bends as a beam: (β L)² with β L = 4.7300.
TEST(KirchhoffPlate, BendsAsABeamWhereItIsNarrow) {
  const auto strip = uniform_plate({1.0, 0.02, 24, 1}, isotropic_bending(1.0, 0.0), 1.0);
  EXPECT_NEAR(numbers_of(plate_modes(strip, 1))(3), 4.7300407 * 4.7300407, 1e-3);
}

TEST(KirchhoffPlate, DoesNotCareWhichWayTheStiffAxisPoints) {
  auto one = uniform_plate({1.0, 0.7, 10, 8}, {2.0, 0.3, 1.0, 0.4}, 1.0);
  auto other = uniform_plate({0.7, 1.0, 8, 10}, {1.0, 0.3, 2.0, 0.4}, 1.0);
  one.masses = {{{0.5, 0.35}, 0.1}};
  other.masses = {{{0.35, 0.5}, 0.1}};
  const auto a = plate_modes(one, 6);
  const auto b = plate_modes(other, 6);
  EXPECT_LT((a.frequency_hz - b.frequency_hz).norm(), 1e-8 * a.frequency_hz.norm());
}

TEST(KirchhoffPlate, IsSmoothFromCellToCell) {
  const auto modes = plate_modes(uneven(), 3);
  const double rim = -0.45 + 0.9 / 12.0 * 7.0;
  constexpr double kStep = 1e-5;
  Eigen::MatrixX2d places(3, 2);
  places << rim - kStep, 0.21, rim, 0.21, rim + kStep, 0.21;
  const Eigen::MatrixXd values = shapes_at(modes, places);
  const Eigen::RowVectorXd left = (values.row(1) - values.row(0)) / kStep;
  const Eigen::RowVectorXd right = (values.row(2) - values.row(1)) / kStep;
  const double curvature = 1e3;  // jumps, times half the step, may show
  EXPECT_LT((left - right).cwiseAbs().maxCoeff(), curvature * kStep);
}

TEST(KirchhoffPlate, KnowsItsCutOuts) {
  const auto modes = plate_modes(uneven(), 2);
  const auto grid = modes.grid;
  EXPECT_FALSE(covers(modes, grid.centre(12 * 5 + 5)));
  EXPECT_TRUE(covers(modes, grid.centre(12 * 5 + 3)));
  EXPECT_TRUE(covers(modes, {0.45, 0.3}));
  EXPECT_FALSE(covers(modes, {0.451, 0.3}));
  EXPECT_THROW((void)shapes_at(modes, grid.centre(12 * 5 + 5).transpose()), InvalidInput);
  EXPECT_NEAR(plate_surface(modes).area.sum(), 0.9 * 0.6 * (1.0 - 3.0 / 144.0), 1e-12);
}

TEST(KirchhoffPlate, FieldsOfOnesGiveBackStiffnessAndMass) {
  auto plate = uneven();
  plate.masses.clear();
  const auto modes = plate_modes(plate, 6);
  const auto sums =
      plate_field_matrices(plate, modes, Eigen::MatrixXd::Ones(plate.grid.cell_count(), 1));
  const Eigen::MatrixXd lambda =
      (2.0 * std::numbers::pi * modes.frequency_hz).cwiseAbs2().asDiagonal();
  EXPECT_LT((sums.stiffness.front() - lambda).norm(), 1e-9 * lambda.norm());
  EXPECT_TRUE(sums.mass.front().isIdentity(1e-9));
}

// First-order perturbation: λ changes by the diagonal of the field's matrix.
TEST(KirchhoffPlate, FieldsSayHowFrequenciesChange) {
  const auto plate = uneven();
  const auto modes = plate_modes(plate, 6);
  const auto cells = plate.grid.cell_count();
  Eigen::MatrixXd field = Dice(9).normal(cells, 1);
  const auto sums = plate_field_matrices(plate, modes, field);
  auto changed = plate;
  constexpr double kStep = 1e-5;
  for (Eigen::Index c = 0; c < cells; ++c) {
    changed.areal_mass(c) *= 1.0 + kStep * field(c);
    auto& bending = changed.bending[static_cast<std::size_t>(c)];
    for (double* d : {&bending.d11, &bending.d12, &bending.d22, &bending.d66}) {
      *d *= 1.0 - kStep * field(c);
    }
  }
  const Eigen::VectorXd lambda = numbers_of(modes).cwiseAbs2();
  const Eigen::VectorXd after = numbers_of(plate_modes(changed, 6)).cwiseAbs2();
  const Eigen::VectorXd expected =
      -sums.stiffness.front().diagonal() - lambda.cwiseProduct(sums.mass.front().diagonal());
  EXPECT_LT(((after - lambda) / kStep - expected).norm(), 1e-3 * expected.norm());
}

TEST(KirchhoffPlate, RefusesWhatCannotBeMeant) {
  auto off = unit_square(4);
  off.masses = {{{0.6, 0.0}, 1.0}};
  EXPECT_THROW((void)plate_modes(off, 1), InvalidInput);
  auto pieces = unit_square(4);
  for (Eigen::Index j = 0; j < 4; ++j) pieces.areal_mass(4 * j + 2) = 0.0;
  EXPECT_THROW((void)plate_modes(pieces, 1), InvalidInput);
  auto soft = unit_square(4);
  soft.bending[3].d66 = 0.0;
  EXPECT_THROW((void)plate_modes(soft, 1), InvalidInput);
  EXPECT_THROW((void)plate_modes(unit_square(1), 14), InvalidInput);
  EXPECT_EQ(plate_modes(unit_square(1), 13).mode_count(), 16);
}

}  // namespace
}  // namespace chladni::simulators
