#include "fem/modes.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "base/turn.h"
#include "fem/assemble.h"
#include "mesh/bodies.h"
#include "rotation/turn.h"
#include "tests/fem/random_body.h"

namespace chladni::fem {
namespace {

// n equal masses in a row, joined by equal springs, ends free: ω_k = 2 √(k/m) sin(kπ / 2n), of
// which the rigid one is known.
System free_chain(int n, double spring, double point_mass) {
  System chain;
  std::vector<Eigen::Triplet<double>> k;
  std::vector<Eigen::Triplet<double>> m;
  for (int i = 0; i < n; ++i) {
    m.emplace_back(i, i, point_mass);
    k.emplace_back(i, i, (i == 0 || i + 1 == n ? 1.0 : 2.0) * spring);
    if (i + 1 < n) k.emplace_back(i + 1, i, -spring);
  }
  chain.stiffness.resize(n, n);
  chain.stiffness.setFromTriplets(k.begin(), k.end());
  chain.mass.resize(n, n);
  chain.mass.setFromTriplets(m.begin(), m.end());
  chain.rigid = Eigen::MatrixXd::Constant(n, 1, 1.0 / std::sqrt(n * std::abs(point_mass)));
  return chain;
}

System plate_system(double length, double width, double thickness, double edge, int order) {
  const auto body =
      mesh::with_order(mesh::layered(mesh::Plate{length, width, thickness}, edge, 1), order);
  return assemble(body, {isotropic(70e9, 0.33, 2700.0)});
}

// The lowest `count`, by Rayleigh quotients in long double of a dense solver's vectors: its own
// values are off by rounding errors of the largest one, which is 1e-7 of the first mode of a beam.
Eigen::VectorXd refined_dense_frequencies(const System& system, Eigen::Index count) {
  const SparseMatrix k_both = system.stiffness.selfadjointView<Eigen::Lower>();
  const SparseMatrix m_both = system.mass.selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd k(k_both);
  const Eigen::MatrixXd m(m_both);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(k, m);
  const auto quotient = [&](Eigen::Index i) {
    const Eigen::VectorX<long double> v = solver.eigenvectors().col(i).cast<long double>();
    return v.dot(k_both.cast<long double>() * v) / v.dot(m_both.cast<long double>() * v);
  };
  Eigen::VectorXd result(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    result(i) = static_cast<double>(std::sqrt(std::max(quotient(i), 0.0L))) / kTwoPi;
  }
  return result;
}

TEST(Modes, OfAFreeChainMatchTheClosedForm) {
  constexpr int n = 200;
  const auto [found, summary] = modes(free_chain(n, 1e7, 0.1), {.count = 11});
  EXPECT_EQ(found.frequency_hz(0), 0.0);
  for (int k = 1; k < 12; ++k) {
    const double omega = 2.0 * std::sqrt(1e7 / 0.1) * std::sin(k * std::numbers::pi / (2 * n));
    EXPECT_NEAR(found.frequency_hz(k) / (omega / kTwoPi), 1.0, 1e-10) << "mode " << k;
  }
  EXPECT_TRUE(summary.complete);
  EXPECT_EQ(summary.text.find("modes below"), 0U) << summary.text;
}

// A mass spread over several elements couples what no stiffness does.
TEST(Modes, HoldWhereTheMassCouplesWhatTheStiffnessDoesNot) {
  auto chain = free_chain(40, 1e4, 0.5);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(40);
  for (const int i : {0, 7, 19, 33, 39}) spread(i) = 0.2 * (i % 3 + 1);
  const Eigen::MatrixXd dense = Eigen::MatrixXd(chain.mass) + spread * spread.transpose();
  chain.mass = Eigen::MatrixXd(dense.triangularView<Eigen::Lower>()).sparseView();
  chain.rigid = Eigen::MatrixXd::Constant(40, 1, 1.0 / std::sqrt(dense.sum()));
  const auto found = modes(chain, {.count = 6}).modes;
  const Eigen::VectorXd expected = refined_dense_frequencies(chain, 7);
  for (Eigen::Index i = 1; i < 7; ++i) {
    EXPECT_NEAR(found.frequency_hz(i) / expected(i), 1.0, 1e-9) << i;
  }
}

TEST(Modes, AreMassNormalisedAndSolveTheirEquation) {
  const auto system = plate_system(0.3, 0.2, 0.01, 0.05, 2);
  const auto [found, summary] = modes(system, {.count = 12});
  EXPECT_LT(summary.orthogonality, 1e-11);
  EXPECT_EQ(found.rigid_count, 6);
  EXPECT_TRUE((found.frequency_hz.head(6).array() == 0.0).all());
  EXPECT_LT(summary.residual.maxCoeff(), 1e-8);
  EXPECT_TRUE(std::is_sorted(found.frequency_hz.begin(), found.frequency_hz.end()));
}

TEST(Modes, AgreeWithADenseSolverOnPlatesBeamsAndPairs) {
  const double sizes[][3] = {{0.3, 0.3, 0.01}, {0.3, 0.2, 0.02}, {0.5, 0.02, 0.002},
                             {0.1, 0.1, 0.1},  {0.4, 0.4, 0.05}, {0.3, 0.05, 0.05}};
  for (const auto& s : sizes) {
    const auto system = plate_system(s[0], s[1], s[2], s[0] / 4.0, 2);
    const auto [found, summary] = modes(system, {.count = 15});
    EXPECT_GE(found.mode_count(), 21);
    const auto expected = refined_dense_frequencies(system, found.mode_count());
    for (Eigen::Index i = 6; i < found.mode_count(); ++i) {
      // What a dense solver is off by itself: rounding of its largest eigenvalue.
      const double largest = expected(expected.size() - 1) / expected(i);
      EXPECT_NEAR(found.frequency_hz(i) / expected(i), 1.0, 1e-9 + 2e-15 * largest * largest)
          << s[0] << " x " << s[1] << " x " << s[2] << " mode " << i;
    }
  }
}

TEST(Modes, DoNotDependOnTheOrderOfTheDegreesOfFreedom) {
  const auto system = plate_system(0.3, 0.3, 0.01, 0.06, 2);
  const auto n = system.mass.rows();
  Eigen::PermutationMatrix<Eigen::Dynamic> shuffle(n);
  shuffle.setIdentity();
  std::shuffle(shuffle.indices().begin(), shuffle.indices().end(), std::mt19937(7));
  const auto renumbered = [&](const SparseMatrix& lower) {
    const SparseMatrix full = lower.selfadjointView<Eigen::Lower>();
    SparseMatrix twisted;
    twisted = full.twistedBy(shuffle);
    return SparseMatrix(twisted.triangularView<Eigen::Lower>());
  };
  System other;
  other.stiffness = renumbered(system.stiffness);
  other.mass = renumbered(system.mass);
  other.rigid = shuffle * system.rigid;
  const auto a = modes(system, {.count = 10}).modes.frequency_hz;
  const auto b = modes(other, {.count = 10}).modes.frequency_hz;
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-9 * a.maxCoeff());
}

TEST(Modes, ScaleWithSizeStiffnessAndDensity) {
  const auto plate = modes(plate_system(0.3, 0.2, 0.01, 0.05, 2), {.count = 6}).modes;
  const auto larger = modes(plate_system(0.6, 0.4, 0.02, 0.1, 2), {.count = 6}).modes;
  EXPECT_LT((2.0 * larger.frequency_hz - plate.frequency_hz).cwiseAbs().maxCoeff(),
            1e-8 * plate.frequency_hz.maxCoeff());
}

TEST(Modes, NeverCutARepeatedOne) {
  // Flexible modes 4 and 5 of a square plate are a pair.
  const auto [found, summary] = modes(plate_system(0.3, 0.3, 0.01, 0.05, 2), {.count = 4});
  ASSERT_EQ(found.mode_count(), 11);
  EXPECT_NEAR(found.frequency_hz(9) / found.frequency_hz(10), 1.0, 1e-6);
  ASSERT_EQ(summary.clusters.size(), 1U);
  EXPECT_EQ(summary.clusters.front().first, 9);
  EXPECT_EQ(summary.clusters.front().size, 2);
}

TEST(Modes, OfAPairComeInOneOrientationWhateverTheStart) {
  const auto system = plate_system(0.3, 0.3, 0.01, 0.05, 2);
  const auto a = modes(system, {.count = 7, .seed = 1}).modes.shapes;
  const auto b = modes(system, {.count = 7, .block = 5, .seed = 99}).modes.shapes;
  ASSERT_EQ(a.cols(), b.cols());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-5 * a.cwiseAbs().maxCoeff());
}

TEST(Modes, AreTheSameBitsOnEveryRun) {
  const auto system = plate_system(0.3, 0.2, 0.01, 0.05, 2);
  const auto first = modes(system, {.count = 8}).modes;
  for (int run = 0; run < 3; ++run) {
    const auto again = modes(system, {.count = 8}).modes;
    EXPECT_TRUE(first.frequency_hz == again.frequency_hz);
    EXPECT_TRUE(first.shapes == again.shapes);
  }
}

// The ball has eigenvalues of multiplicity 5, 5, 3, 7, 7: more than a block of 4 sees at once.
TEST(Modes, OfABallHaveAllTheirMultiplicities) {
  const mesh::Sphere ball{.diameter = 0.2};
  auto body = mesh::with_order(mesh::layered(ball, 0.025), 2);
  mesh::project_to_sphere(body, ball);
  const auto system = assemble(body, {isotropic(200e9, 0.3, 8000.0)});
  const auto [found, summary] = modes(system, {.count = 27});
  const double exact[] = {12343.553, 13059.571, 17421.141, 19073.009, 19431.805};
  const int multiplicity[] = {5, 5, 3, 7, 7};
  Eigen::Index i = 6;
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < multiplicity[k]; ++j, ++i) {
      EXPECT_NEAR(found.frequency_hz(i) / exact[k], 1.0, 2e-3) << "mode " << i;
    }
  }
  EXPECT_TRUE(summary.complete);
}

TEST(Modes, LieAboveTheExactOnesAndFallWithTheMesh) {
  double before = 1.0;
  for (const double edge : {0.15, 0.075, 0.0375}) {
    const double f =
        modes(plate_system(0.6, 0.6, 0.02, edge, 2), {.count = 1}).modes.frequency_hz(6);
    const double error = f / 178.9033 - 1.0;
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, before);
    before = error;
  }
}

// A cube between frictionless walls has smooth modes in closed form; the lowest are three shear
// waves along the face diagonals, ω² = 2 (G/ρ) (π/L)². Eigenvalues converge with order 2p = 4.
TEST(Modes, OfACubeBetweenWallsConvergeWithOrderFour) {
  const double shear_modulus = 200e9 / 2.6;
  const double exact = std::sqrt(2.0 * shear_modulus / 8000.0) / (2.0 * 0.1);
  std::vector<double> error;
  for (const int cells : {2, 4, 8}) {
    const auto body =
        mesh::with_order(mesh::layered(mesh::Plate{0.1, 0.1, 0.1}, 0.1 / cells, cells), 2);
    const std::vector<Support> walls{{.patch = "x_min", .x = true}, {.patch = "x_max", .x = true},
                                     {.patch = "y_min", .y = true}, {.patch = "y_max", .y = true},
                                     {.patch = "top", .z = true},   {.patch = "bottom", .z = true}};
    const auto system = assemble(body, {isotropic(200e9, 0.3, 8000.0)}, walls);
    EXPECT_EQ(system.rigid.cols(), 0);
    error.push_back(modes(system, {.count = 3}).modes.frequency_hz(0) / exact - 1.0);
    EXPECT_GT(error.back(), 0.0);
  }
  EXPECT_NEAR(std::log2(error[1] / error[2]), 4.0, 0.4);
}

TEST(Modes, RefuseACountTheSystemCannotHave) {
  EXPECT_THROW((void)modes(free_chain(5, 1.0, 1.0), {.count = 5}), InvalidInput);
  EXPECT_THROW((void)modes(free_chain(5, 1.0, 1.0), {.count = 0}), InvalidInput);
}

TEST(Modes, OfAllThatThereAreAreFound) {
  const auto found = modes(free_chain(6, 1e4, 1.0), {.count = 5}).modes;
  EXPECT_EQ(found.mode_count(), 6);
}

// The basis grows to more than half of the space, and the Ritz values are looked at now and then.
TEST(Modes, OfAThirdOfAllMatchTheClosedForm) {
  constexpr int kMasses = 900;
  const auto result = modes(free_chain(kMasses, 1e6, 2.0), {.count = 300});
  ASSERT_GE(result.modes.mode_count(), 301);
  EXPECT_TRUE(result.summary.complete);
  for (Eigen::Index k = 1; k <= 300; ++k) {
    const double angle = static_cast<double>(k) * std::numbers::pi / (2.0 * kMasses);
    const double exact = 2.0 * std::sqrt(1e6 / 2.0) * std::sin(angle) / kTwoPi;
    EXPECT_NEAR(result.modes.frequency_hz(k), exact, 1e-9 * exact) << k;
  }
}

TEST(Modes, SayWhenTheMassIsNotPositiveDefinite) {
  EXPECT_THROW((void)modes(free_chain(30, 1e7, -0.1), {.count = 3}), NumericalFailure);
}

TEST(Modes, RefuseWhatDoesNotFitInMemoryBeforeTheyStart) {
  try {
    (void)modes(plate_system(0.3, 0.2, 0.01, 0.05, 2), {.count = 5, .memory_limit_bytes = 100000});
    FAIL();
  } catch (const OutOfResources& e) {
    EXPECT_NE(std::string(e.what()).find("coarser mesh"), std::string::npos) << e.what();
  }
}

// 100 of the 10 000 that bench/fem/random_bodies runs: plates, beams, blocks and pairs with masses,
// springs and resonators. Every one must have as many modes as inertia counts (the solver throws
// otherwise), and they must be those of a dense solver.
TEST(Modes, OfRandomBodiesAreNeverLost) {
  EVERY_FOURTH_LANDING();
  double worst = 0.0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const auto body = random_body(seed);
    const auto [found, summary] = modes(body.system, body.options);
    EXPECT_TRUE(summary.complete) << body.text;
    const auto expected = dense_lambda(body.system, found.mode_count());
    EXPECT_EQ(differing_modes(found.frequency_hz, expected), 0) << body.text;
    if (body.system.suspended.cols() > 0) continue;  // what K's entries say of springs is less
    const auto own = expected.value.tail(found.mode_count() - found.rigid_count).array();
    worst = std::max(worst, (expected.rounding.tail(own.size()).array() / own).maxCoeff());
  }
  EXPECT_LT(worst, 1e-4) << "of a mode's own eigenvalue, which is what the comparison can tell";
}

}  // namespace
}  // namespace chladni::fem
