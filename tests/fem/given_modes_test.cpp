#include "fem/given_modes.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/turn.h"
#include "fem/assemble.h"
#include "fem/eigen/symmetric_product.h"
#include "fem/factor/factorization.h"
#include "mesh/bodies.h"
#include "tests/refusal.h"

namespace chladni::fem {
namespace {

// Modes of a dense eigensolver, as a sound program would give them: it shares nothing with ours.
GivenModes dense_modes(const System& system, Eigen::Index count) {
  const SparseMatrix k = system.stiffness.selfadjointView<Eigen::Lower>();
  const SparseMatrix m = system.mass.selfadjointView<Eigen::Lower>();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(k),
                                                                         Eigen::MatrixXd(m)};
  GivenModes given;
  given.lambda = solver.eigenvalues().head(count);
  given.shapes = solver.eigenvectors().leftCols(count);
  given.shift = inverted_shift(system);
  given.bound = std::sqrt(solver.eigenvalues()(count - 1) * solver.eigenvalues()(count));
  given.counted = count;
  const Eigen::MatrixXd residual = k * given.shapes - m * given.shapes * given.lambda.asDiagonal();
  const Eigen::MatrixXd shifted = Eigen::MatrixXd(k) + given.shift * Eigen::MatrixXd(m);
  given.corrections = shifted.ldlt().solve(residual);
  return given;
}

class ModesOfAnother : public testing::Test {
 protected:
  // Why the modes are refused after `change`; empty where they are taken.
  std::string refused(const std::function<void(GivenModes&)>& change) const {
    GivenModes given = given_;
    change(given);
    return refusal_of([&] { return checked_modes(system_, given, {.count = 6}); });
  }
  static void expect_said(const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << "\"" << said << "\"";
  }

  System system_ = assemble(mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, 0.1, 1), 2),
                            {isotropic(70e9, 0.33, 2700.0)});
  GivenModes given_ = dense_modes(system_, 18);
};

TEST_F(ModesOfAnother, AreOursToTheLastDigits) {
  const auto own = modes(system_, {.count = 6});
  const auto checked = checked_modes(system_, given_, {.count = 6});
  ASSERT_EQ(checked.modes.frequency_hz.size(), own.modes.frequency_hz.size());
  EXPECT_EQ(checked.modes.rigid_count, 6);
  const Eigen::VectorXd ratio =
      checked.modes.frequency_hz.tail(6).cwiseQuotient(own.modes.frequency_hz.tail(6));
  // The rounding of K moves the lowest by some 1e-11 of itself, by another part under each kernel.
  EXPECT_LT((ratio.array() - 1.0).abs().maxCoeff(), 5e-11);
  EXPECT_LT((checked.modes.shapes - own.modes.shapes).cwiseAbs().maxCoeff(),
            1e-8 * own.modes.shapes.cwiseAbs().maxCoeff());
  EXPECT_TRUE(checked.summary.complete);
  EXPECT_EQ(checked.summary.counted, 18);
  EXPECT_EQ(checked.summary.found, 18);
  EXPECT_LT(checked.summary.orthogonality, 1e-10);
}

// The given modes with φ_7 and φ_i turned into each other, where i may be one that is not given.
GivenModes mixed(const System& system, const GivenModes& all, const GivenModes& given,
                 Eigen::Index i, double angle) {
  GivenModes rough = given;
  const Eigen::VectorXd other = all.shapes.col(i);
  rough.shapes.col(7) = std::cos(angle) * all.shapes.col(7) + std::sin(angle) * other;
  if (i < given.lambda.size()) {
    rough.shapes.col(i) = std::cos(angle) * other - std::sin(angle) * all.shapes.col(7);
  }
  const SparseMatrix k = system.stiffness.selfadjointView<Eigen::Lower>();
  const SparseMatrix m = system.mass.selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd residual = k * rough.shapes - m * rough.shapes * rough.lambda.asDiagonal();
  rough.corrections = Eigen::MatrixXd(k + rough.shift * m).ldlt().solve(residual);
  return rough;
}

// Shapes that are mixed among themselves span the right space: Rayleigh-Ritz finds the modes in it.
TEST_F(ModesOfAnother, AreFoundInTheirSpan) {
  const auto exact = checked_modes(system_, given_, {.count = 6});
  const auto found = checked_modes(system_, mixed(system_, given_, given_, 12, 1e-4), {.count = 6});
  EXPECT_LT(std::abs(found.modes.frequency_hz(7) / exact.modes.frequency_hz(7) - 1.0), 1e-11);
  EXPECT_LT(found.summary.residual(7), 1e-8);
}

// An error ε from outside of it is the residual; a step of inverse iteration leaves less of it, and
// of the frequency ε².
TEST_F(ModesOfAnother, TellTheirErrorsAndAreRefined) {
  const auto exact = checked_modes(system_, given_, {.count = 6});
  const double wrong = 1e-5;
  const auto rough = mixed(system_, dense_modes(system_, 41), given_, 40, wrong);
  const auto found = checked_modes(system_, rough, {.count = 6});
  EXPECT_LT(std::abs(found.modes.frequency_hz(7) / exact.modes.frequency_hz(7) - 1.0), 1e-10);
  EXPECT_LT((found.modes.shapes.col(7) - exact.modes.shapes.col(7)).norm(),
            0.3 * wrong * exact.modes.shapes.col(7).norm());
  EXPECT_GT(found.summary.residual(7), 0.3 * wrong);
  EXPECT_LT(found.summary.residual(7), 10.0 * wrong);
  EXPECT_FALSE(found.summary.warnings.empty());
}

TEST_F(ModesOfAnother, ThatAreNotModesAreRefused) {
  expect_said(refused([](auto& g) { g.shapes.conservativeResize(g.shapes.rows() - 1, 18); }),
              "rows");
  expect_said(refused([](auto& g) { g.lambda.conservativeResize(17); }), "rows");
  expect_said(refused([](auto& g) { g.shapes(5, 9) = std::nan(""); }), "finite");
  expect_said(refused([](auto& g) { g.lambda(9) = std::numeric_limits<double>::infinity(); }),
              "finite");
  expect_said(refused([](auto& g) { std::swap(g.lambda(8), g.lambda(11)); }), "out of order");
  expect_said(refused([](auto& g) { g.shapes.col(9) *= 1.01; }), "orthonormal");
  expect_said(refused([](auto& g) { g.shapes.col(9) = g.shapes.col(10); }), "orthonormal");
  expect_said(refused([](auto& g) { g.shapes.col(9).swap(g.shapes.col(12)); }), "energy");
  expect_said(refused([](auto& g) { g.lambda(17) *= 1.001; }), "energy");
  expect_said(refused([](auto& g) { g.bound = g.lambda(16); }), "bound");
  expect_said(refused([](auto& g) { g.shapes.col(3).swap(g.shapes.col(7)); }), "whole body");
  EXPECT_EQ(refused([](auto&) {}), "");
}

// A shape that is mixed with its neighbour, with corrections that say it is exact.
TEST_F(ModesOfAnother, CorrectionsThatHideAnErrorAreRefused) {
  expect_said(refused([](auto& g) {
                const Eigen::VectorXd a = g.shapes.col(8);
                const Eigen::VectorXd b = g.shapes.col(9);
                const double e = 1e-3;
                g.shapes.col(8) = std::sqrt(1.0 - e * e) * a + e * b;
                g.shapes.col(9) = std::sqrt(1.0 - e * e) * b - e * a;
                g.lambda(8) += e * e * (g.lambda(9) - g.lambda(8));
              }),
              "does not solve");
  expect_said(refused([](auto& g) { g.corrections.col(7) = 1e-6 * g.shapes.col(12); }),
              "does not solve");
}

TEST_F(ModesOfAnother, ThatMissAModeFail) {
  GivenModes given = given_;
  given.counted = 19;
  EXPECT_THROW((void)checked_modes(system_, given, {.count = 6}), NumericalFailure);
  given.counted = 17;
  EXPECT_THROW((void)checked_modes(system_, given, {.count = 6}), NumericalFailure);
  EXPECT_THROW((void)checked_modes(system_, given_, {.count = 13}), NumericalFailure);
}

// One mode left out in the middle: 17 found, 18 counted.
TEST_F(ModesOfAnother, ThatWereLeftOutAreCounted) {
  GivenModes given = given_;
  Eigen::VectorXi kept(17);
  kept << Eigen::VectorXi::LinSpaced(9, 0, 8), Eigen::VectorXi::LinSpaced(8, 10, 17);
  given.lambda = given_.lambda(kept).eval();
  given.shapes = given_.shapes(Eigen::all, kept).eval();
  given.corrections = given_.corrections(Eigen::all, kept).eval();
  try {
    (void)checked_modes(system_, given, {.count = 6});
    FAIL();
  } catch (const NumericalFailure& failure) {
    expect_said(failure.what(), "18 modes were counted but 17 found");
  }
}

}  // namespace
}  // namespace chladni::fem
