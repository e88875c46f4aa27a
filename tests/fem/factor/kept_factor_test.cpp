// What is kept of a system serves that system alone.
#include "fem/factor/kept_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/factor/factorization.h"
#include "fem/modes.h"
#include "fem/reduced.h"
#include "host/parallel.h"
#include "mesh/bodies.h"

namespace chladni::fem {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

System thin_plate() {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, 0.05, 1), 2);
  return assemble(body, {isotropic(70e9, 0.33, 2700.0)});
}

KeptFactor::Shifted kept_of(const System& system) {
  return system.kept_factor->kept(system.stiffness, system.mass, 0.0, kAny);
}

TEST(KeptFactor, ServesOnlyTheSamePatternAndThreads) {
  const auto system = thin_plate();
  KeptFactor kept;
  const auto first = kept.symbolic(system.stiffness, system.mass);
  EXPECT_EQ(kept.symbolic(2.0 * system.stiffness, system.mass), first);
  const int before = thread_count();
  set_thread_count(before + 1);
  const auto more = kept.symbolic(system.stiffness, system.mass);
  EXPECT_NE(more, first);
  EXPECT_EQ(more->threads(), before + 1);
  set_thread_count(before);
  SparseMatrix wider = system.stiffness;
  wider.coeffRef(wider.rows() - 1, 0) = 1.0;
  EXPECT_NE(kept.symbolic(wider, system.mass), kept.symbolic(system.stiffness, system.mass));
}

TEST(KeptFactor, ServesOnlyTheSameMatricesToTheLastBit) {
  const auto system = thin_plate();
  KeptFactor kept;
  const auto factor = kept.factor(system.stiffness, 1e7, system.mass, kAny);
  EXPECT_EQ(kept.factor(system.stiffness, 1e7, system.mass, kAny), factor);
  EXPECT_EQ(kept.kept(system.stiffness, system.mass, 1e6, 1e8).factor, factor);
  EXPECT_EQ(kept.kept(system.stiffness, system.mass, 1e6, 1e8).s, 1e7);
  EXPECT_EQ(kept.kept(system.stiffness, system.mass, 2e7, 1e8).factor, nullptr);
  EXPECT_EQ(kept.kept(system.stiffness, system.mass, 1e6, 9e6).factor, nullptr);
  for (const Eigen::Index i : {Eigen::Index{0}, system.stiffness.rows() - 1}) {
    auto other = system;
    double& entry = other.stiffness.coeffRef(i, i);
    entry = std::nextafter(entry, kAny);
    EXPECT_EQ(kept.kept(other.stiffness, other.mass, 0.0, kAny).factor, nullptr);
    double& mass = other.mass.coeffRef(i, i);
    mass = std::nextafter(mass, kAny);
    EXPECT_EQ(kept.kept(system.stiffness, other.mass, 0.0, kAny).factor, nullptr);
  }
  EXPECT_NE(kept.factor(system.stiffness, 2e7, system.mass, kAny), factor);
}

TEST(KeptFactor, IsNotKeptWhereItIsLarge) {
  const auto system = thin_plate();
  KeptFactor kept;
  EXPECT_NE(kept.factor(system.stiffness, 1e7, system.mass, 1e3), nullptr);
  EXPECT_EQ(kept.kept(system.stiffness, system.mass, 0.0, kAny).factor, nullptr);
}

TEST(KeptFactor, IsNotMadeOfAMatrixThatIsNotDefinite) {
  auto system = thin_plate();
  system.stiffness.coeffRef(5, 5) *= -1.0;
  EXPECT_THROW((void)modes(system, {.count = 3}), NumericalFailure);
  EXPECT_EQ(kept_of(system).factor, nullptr);
}

TEST(KeptFactor, ServesMoreModesOfTheSameSystem) {
  const auto system = thin_plate();
  const auto few = modes(system, {.count = 4}).modes;
  const auto factor = kept_of(system).factor;
  ASSERT_NE(factor, nullptr);
  const auto more = modes(system, {.count = 12}).modes;
  EXPECT_EQ(kept_of(system).factor, factor);
  const auto alone = modes(thin_plate(), {.count = 12}).modes;
  EXPECT_EQ(more.frequency_hz, alone.frequency_hz);  // the same bits
  EXPECT_EQ(more.shapes, alone.shapes);
  EXPECT_NEAR(few.frequency_hz(9) / alone.frequency_hz(9), 1.0, 1e-9);
}

TEST(KeptFactor, GivesTheSameReducedModel) {
  const auto system = thin_plate();
  const auto found = modes(system, {.count = 12}).modes;
  ASSERT_NE(kept_of(system).factor, nullptr);
  SparseMatrix forces(system.stiffness.rows(), 3);
  for (int j = 0; j < 3; ++j) forces.insert(3 * (j + 1) * (j + 1) + 2, j) = 1.0;
  const auto by_kept = residual_flexibility(system, found, forces);
  auto alone = system;
  alone.kept_factor = std::make_shared<KeptFactor>();
  const auto by_own = residual_flexibility(alone, found, forces);
  EXPECT_LT((by_kept - by_own).norm(), 1e-11 * by_own.norm());
}

}  // namespace
}  // namespace chladni::fem
