#include "fem/eigen/certificate.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"

namespace chladni::fem {
namespace {

// Pairs [[d, c], [c, d]] on the diagonal, M = 1: eigenvalues d ± c.
System pairs(const std::vector<std::pair<double, double>>& all) {
  System system;
  const auto n = 2 * static_cast<Eigen::Index>(all.size());
  std::vector<Eigen::Triplet<double>> k;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int first = 2 * static_cast<int>(i);
    k.emplace_back(first, first, all[i].first);
    k.emplace_back(first + 1, first + 1, all[i].first);
    k.emplace_back(first + 1, first, all[i].second);
  }
  system.stiffness.resize(n, n);
  system.stiffness.setFromTriplets(k.begin(), k.end());
  system.mass.resize(n, n);
  system.mass.setIdentity();
  return system;
}

// Eigenvalues 55 and 155; the pivot at 105, the middle of the gap, is nothing or rounding.
TEST(CountedInGap, GoesToAnotherPlaceWhereAPivotIsTiny) {
  for (const double off : {0.0, 1e-13, -1e-13, 1e-10, -3e-9}) {
    const auto system = pairs({{105.0 + off, 50.0}, {300.0, 10.0}});
    const Symbolic symbolic(system.stiffness, system.mass);
    const auto count = counted_in_gap(symbolic, system, 100.0, 110.0);
    EXPECT_EQ(count.below, 1) << off;
    EXPECT_EQ(count.attempts, 2) << off;
    EXPECT_GT(count.at, 100.0);
    EXPECT_LT(count.at, 110.0);
    EXPECT_NE(count.at, 105.0);
  }
}

TEST(CountedInGap, StaysWhereNothingIsTiny) {
  const auto system = pairs({{105.5, 50.0}, {300.0, 10.0}});
  const Symbolic symbolic(system.stiffness, system.mass);
  EXPECT_EQ(counted_in_gap(symbolic, system, 100.0, 110.0).attempts, 1);
}

// A tiny pivot wherever one counts: refused with the figures in full, not with 0.000000.
TEST(CountedInGap, RefusesWhereNoPlaceCanBeTrusted) {
  std::vector<std::pair<double, double>> all;
  for (const double place : {0.5, 0.38, 0.62, 0.27, 0.73}) {
    all.emplace_back(100.0 + place * 10.0 + 1e-12, 50.0);
  }
  const auto system = pairs(all);
  const Symbolic symbolic(system.stiffness, system.mass);
  try {
    (void)counted_in_gap(symbolic, system, 100.0, 110.0);
    FAIL();
  } catch (const NumericalFailure& failure) {
    const std::string text = failure.what();
    EXPECT_NE(text.find("Hz cannot be counted: the smallest pivot is "), std::string::npos) << text;
    EXPECT_NE(text.find("e-1"), std::string::npos) << text;
    EXPECT_EQ(text.find("0.000000"), std::string::npos) << text;
  }
}

// What a user can do about a plate of 1:30000 and one of 1:10000: the message says it.
TEST(Modes, OfABodyBeyondDoublePrecisionSayWhy) {
  for (const double thickness : {3e-5, 1e-5, 1e-6}) {
    const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, thickness}, 0.05, 1), 2);
    try {
      (void)modes(assemble(body, {isotropic(70e9, 0.33, 2700.0)}), {.count = 5});
      ADD_FAILURE() << thickness;
    } catch (const NumericalFailure& failure) {
      const std::string text = failure.what();
      EXPECT_NE(text.find("(length / thickness)^4"), std::string::npos) << text;
      EXPECT_NE(text.find("make the body thicker or smaller"), std::string::npos) << text;
      EXPECT_NE(text.find("mesh.edge_length"), std::string::npos) << text;
    }
  }
}

// A shift on an eigenvalue: the last pivot is what rounding left of it.
TEST(Inertia, SeesAShiftOnAnEigenvalue) {
  const auto system = pairs({{105.0, 50.0}, {300.0, 10.0}});
  const Symbolic symbolic(system.stiffness, system.mass);
  for (const double value : {55.0, 155.0, 290.0}) {
    const auto found = inertia(symbolic, system.stiffness, -value, system.mass);
    EXPECT_LT(found.smallest_pivot, 1e-14);
    EXPECT_FALSE(found.trusted());
  }
  EXPECT_GT(inertia(symbolic, system.stiffness, -60.0, system.mass).smallest_pivot, 1e-3);
}

TEST(Inertia, SaysHowMuchTheEliminationMadeEntriesGrow) {
  for (const double tiny : {1e-2, 1e-5, 1e-9}) {
    const auto system = pairs({{tiny, 1.0}});
    const Symbolic symbolic(system.stiffness, system.mass);
    const auto found = inertia(symbolic, system.stiffness, 0.0, system.mass);
    EXPECT_NEAR(found.growth * tiny, 1.0, 0.01);
    EXPECT_NEAR(found.smallest_pivot / tiny, 1.0, 0.01);
  }
}

// ---- Where the first search misses modes.

// Chains of n masses between walls, uncoupled and equal: every eigenvalue as often as there are
// chains, of which one vector per step sees one.
System equal_chains(int count, int n) {
  System system;
  std::vector<Eigen::Triplet<double>> k;
  for (int at = 0; at < count * n; ++at) {
    k.emplace_back(at, at, 2e6);
    if (at % n + 1 < n) k.emplace_back(at + 1, at, -1e6);
  }
  system.stiffness.resize(count * n, count * n);
  system.stiffness.setFromTriplets(k.begin(), k.end());
  system.mass.resize(count * n, count * n);
  system.mass.setIdentity();
  return system;
}

// Short chains: the search is at its end before rounding has brought in the copies, whatever the
// kernel of the BLAS. With 200 masses it did so under some of them.
TEST(Modes, ThatWereMissedAreFoundByRestarts) {
  for (const int chains : {2, 3, 4}) {
    const int n = 50;
    const auto found =
        modes(equal_chains(chains, n), {.count = 3 * chains, .tolerance = 1e-6, .block = 1});
    EXPECT_GT(found.summary.restarts, 0) << "nothing was missed: the test tells nothing";
    EXPECT_TRUE(found.summary.complete);
    ASSERT_EQ(found.modes.mode_count(), 3 * chains);
    for (int i = 0; i < 3 * chains; ++i) {
      const int k = i / chains + 1;
      const double omega = 2e3 * std::sin(0.5 * std::numbers::pi * k / (n + 1));
      EXPECT_NEAR(found.modes.frequency_hz(i) * 2.0 * std::numbers::pi / omega, 1.0, 1e-6) << i;
    }
    EXPECT_LT(found.summary.orthogonality, 1e-10);
    // A restart is orthogonal to shapes that are as good as the tolerance: each copy of a mode adds
    // their error, up to the ratio of the eigenvalues, 9. It is said since it is more than 1e-9.
    EXPECT_LT(found.summary.residual.maxCoeff(), 9.0 * chains * 1e-6);
    const auto& warnings = found.summary.warnings;
    EXPECT_EQ(found.summary.clusters.size(), 3U);
    ASSERT_EQ(warnings.empty(), found.summary.residual.maxCoeff() <= 1e-9);
    if (warnings.empty()) continue;
    EXPECT_NE(warnings.front().find("solve their equation to more than 1e-09"), std::string::npos)
        << warnings.front();
  }
}

}  // namespace
}  // namespace chladni::fem
