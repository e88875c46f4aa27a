#include "modal/pairing.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "base/error.h"

namespace chladni::modal {
namespace {

// Two rigid-body modes, flexible ones at 100, 200, 200 (a pair), 300 and 450 Hz.
Modes plate_modes() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Modes modes;
  modes.frequency_hz = (Eigen::VectorXd(7) << 0, 0, 100, 200, 200, 300, 450).finished();
  modes.damping_ratio = Eigen::VectorXd::Zero(7);
  const Eigen::MatrixXd any = Eigen::MatrixXd::NullaryExpr(12, 7, [&] { return normal(random); });
  modes.shapes = any.householderQr().householderQ() * Eigen::MatrixXd::Identity(12, 7);
  modes.rigid_count = 2;
  return modes;
}

void turn(Modes& modes, Eigen::Index first, double angle) {
  Eigen::Matrix2d by;
  by << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  modes.shapes.middleCols<2>(first) = (modes.shapes.middleCols<2>(first) * by).eval();
}

TEST(Pairing, OfASetWithItselfIsTheIdentity) {
  const auto found = pairing(plate_modes(), plate_modes());
  ASSERT_EQ(found.pairs.size(), 7U);
  for (const auto& pair : found.pairs) {
    EXPECT_EQ(pair.a, pair.b);
    EXPECT_NEAR(pair.mac, 1.0, 1e-13);
    EXPECT_EQ(pair.frequency_change, 0.0);
  }
  EXPECT_TRUE(found.alone_a.empty());
  EXPECT_TRUE(found.alone_b.empty());
}

TEST(Pairing, ComparesRepeatedModesByTheirSubspace) {
  auto measured = plate_modes();
  turn(measured, 0, 0.4);             // rigid-body modes about other axes
  turn(measured, 3, std::atan(1.0));  // the pair, at 45 degrees: single MACs are one half
  measured.frequency_hz(3) = 197.0;   // and split by an imperfection
  measured.frequency_hz(4) = 203.0;
  const auto found = pairing(plate_modes(), measured);
  ASSERT_EQ(found.pairs.size(), 7U);
  for (const auto& pair : found.pairs) {
    EXPECT_EQ(pair.a, pair.b);
    EXPECT_NEAR(pair.mac, 1.0, 1e-13);
  }
  EXPECT_NEAR(found.pairs[3].frequency_change, -0.015, 1e-12);
}

TEST(Pairing, FollowsShapesWhenModesChangePlaces) {
  auto other = plate_modes();
  other.shapes.col(5).swap(other.shapes.col(6));
  other.shapes.col(2) *= -7.0;
  const auto found = pairing(plate_modes(), other);
  ASSERT_EQ(found.pairs.size(), 7U);
  EXPECT_EQ(found.pairs[2].b, 2);
  EXPECT_EQ(found.pairs[5].b, 6);
  EXPECT_EQ(found.pairs[6].b, 5);
  EXPECT_NEAR(found.pairs[5].frequency_change, 0.5, 1e-12);
}

TEST(Pairing, LeavesAloneWhatHasNoPartner) {
  const auto all = plate_modes();
  auto some = all;
  some.frequency_hz = (Eigen::VectorXd(5) << 0, 0, 100, 200, 450).finished();
  some.shapes = all.shapes(Eigen::all, std::vector<Eigen::Index>{0, 1, 2, 3, 6}).eval();
  some.damping_ratio = Eigen::VectorXd::Zero(5);
  const auto found = pairing(all, some);
  EXPECT_EQ(found.pairs.size(), 5U);
  EXPECT_EQ(found.alone_a, (std::vector<Eigen::Index>{4, 5}));
  EXPECT_TRUE(found.alone_b.empty());
  const auto turned = pairing(some, all);
  EXPECT_EQ(turned.pairs.size(), 5U);
  EXPECT_EQ(turned.alone_b, (std::vector<Eigen::Index>{4, 5}));
}

TEST(Pairing, NeverTakesARigidBodyModeForAFlexibleOne) {
  auto held = plate_modes();
  held.rigid_count = 0;
  held.frequency_hz.head(2) << 3.0, 4.0;  // on soft springs now
  const auto found = pairing(plate_modes(), held);
  EXPECT_EQ(found.alone_a, (std::vector<Eigen::Index>{0, 1}));
  EXPECT_EQ(found.alone_b, (std::vector<Eigen::Index>{0, 1}));
}

// One mode of each set is like none of the other. Wherever these lie, they change no other pair.
TEST(Pairing, KeepsPairsBesideModesThatNothingIsLike) {
  const auto all = plate_modes();
  for (const double factor : {1.0, 0.01, 100.0}) {
    auto one = all;
    auto other = all;
    one.shapes = all.shapes.leftCols(6).eval();
    other.shapes = all.shapes(Eigen::all, std::vector<Eigen::Index>{0, 1, 2, 3, 4, 6}).eval();
    one.frequency_hz = (Eigen::VectorXd(6) << 0, 0, 100, 200, 200, 300 * factor).finished();
    other.frequency_hz = (Eigen::VectorXd(6) << 0, 0, 100, 200, 200, 450 / factor).finished();
    one.damping_ratio = other.damping_ratio = Eigen::VectorXd::Zero(6);
    const auto found = pairing(one, other);
    ASSERT_EQ(found.pairs.size(), 5U) << factor;
    for (const auto& pair : found.pairs) {
      EXPECT_EQ(pair.a, pair.b);
      EXPECT_NEAR(pair.mac, 1.0, 1e-13);
    }
    EXPECT_EQ(found.alone_a, std::vector<Eigen::Index>{5});
    EXPECT_EQ(found.alone_b, std::vector<Eigen::Index>{5});
  }
}

// Two pairs of a MAC of 0.64 are not worth one of 1; and no distance in frequency forbids a pair.
TEST(Pairing, KeepsAPairOfOneShape) {
  Modes one;
  one.frequency_hz = Eigen::Vector2d(100.0, 110.0);
  one.damping_ratio = Eigen::VectorXd::Zero(2);
  one.shapes = Eigen::MatrixXd{{1.0, 0.8}, {0.0, 0.6}, {0.0, 0.0}};
  auto other = one;
  other.shapes = Eigen::MatrixXd{{1.0, 0.8}, {0.0, 0.0}, {0.0, 0.6}};
  for (const double far : {1.0, 20.0}) {
    other.frequency_hz = far * one.frequency_hz;
    const auto found = pairing(one, other, {.least_mac = 0.6});
    ASSERT_EQ(found.pairs.size(), 1U) << far;
    EXPECT_EQ(found.pairs[0].a, 0);
    EXPECT_EQ(found.pairs[0].b, 0);
    EXPECT_EQ(found.pairs[0].mac, 1.0);
  }
}

// A pair just above the least MAC, however far apart in frequency, is made where no other is.
TEST(Pairing, MakesAFarPairOfTheLeastLikeness) {
  Modes one;
  one.frequency_hz = Eigen::VectorXd::Constant(1, 100.0);
  one.damping_ratio = Eigen::VectorXd::Zero(1);
  one.shapes = Eigen::Vector3d(1.0, 0.0, 0.0);
  auto other = one;
  other.shapes = Eigen::Vector3d(0.8, 0.0, 0.6);
  other.frequency_hz *= 20.0;
  EXPECT_EQ(pairing(one, other, {.least_mac = 0.6}).pairs.size(), 1U);
}

// The least cost over all permutations, by trying all of them.
TEST(Pairing, IsTheBestOneThereIs) {
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    const auto any = [&] {
      Modes modes;
      modes.frequency_hz = Eigen::VectorXd::LinSpaced(6, 100.0, 600.0);
      modes.damping_ratio = Eigen::VectorXd::Zero(6);
      modes.shapes = Eigen::MatrixXd::NullaryExpr(4, 6, [&] { return normal(random); });
      return modes;
    };
    const auto a = any();
    const auto b = any();
    const Eigen::MatrixXd alike =
        (a.shapes.colwise().normalized().transpose() * b.shapes.colwise().normalized()).cwiseAbs2();
    std::vector<Eigen::Index> order(6);
    std::iota(order.begin(), order.end(), 0);
    double best = 0.0;
    do {
      double sum = 0.0;
      for (std::size_t i = 0; i < 6; ++i) sum += alike(static_cast<Eigen::Index>(i), order[i]);
      best = std::max(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    const auto found = pairing(a, b, {.least_mac = 0.0, .frequency_weight = 0.0});
    double sum = 0.0;
    for (const auto& pair : found.pairs) sum += pair.mac;
    EXPECT_NEAR(sum, best, 1e-12);
  }
}

// Each row may stay without a column for this much.
TEST(Assigned, NeedsAPairToCostLessThanNone) {
  const double alone = 0.05;
  EXPECT_TRUE(assigned(Eigen::MatrixXd::Constant(1, 1, alone), alone).empty());
  EXPECT_EQ(assigned(Eigen::MatrixXd::Constant(1, 1, 0.99 * alone), alone).size(), 1U);
}

TEST(Pairing, RefusesSetsOfDifferentPlaces) {
  auto other = plate_modes();
  other.shapes = other.shapes.topRows(5).eval();
  EXPECT_THROW((void)pairing(plate_modes(), other), InvalidInput);
}

}  // namespace
}  // namespace chladni::modal
