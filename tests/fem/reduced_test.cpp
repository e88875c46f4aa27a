#include "fem/reduced.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/material.h"
#include "mesh/bodies.h"
#include "mesh/site.h"
#include "modal/frf.h"

namespace chladni::fem {
namespace {

Eigen::MatrixXd full_matrix(const SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

// A coarse plate with two dashpots, solved densely; four corners and the middle are channels.
struct Structure {
  System system;
  Eigen::VectorXd eigenvalues;
  Eigen::MatrixXd shapes;
  Eigen::Index rigid_count = 0;
  SparseMatrix channels;

  [[nodiscard]] modal::Modes modes(Eigen::Index count) const {
    modal::Modes result;
    result.frequency_hz =
        eigenvalues.head(count).cwiseMax(0.0).cwiseSqrt() / (2.0 * std::numbers::pi);
    result.frequency_hz.head(rigid_count).setZero();
    result.damping_ratio = Eigen::VectorXd::Zero(count);
    result.shapes = shapes.leftCols(count);
    result.shapes.leftCols(rigid_count) = system.rigid;
    result.rigid_count = rigid_count;
    return result;
  }
  [[nodiscard]] Eigen::MatrixXcd direct(double frequency_hz) const {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency_hz);
    const Eigen::MatrixXcd dynamic = full_matrix(system.stiffness).cast<std::complex<double>>() +
                                     s * full_matrix(system.damping) +
                                     s * s * full_matrix(system.mass);
    const Eigen::MatrixXd b(channels);
    return b.transpose() * dynamic.partialPivLu().solve(b.cast<std::complex<double>>());
  }
};

Structure structure(bool held) {
  const auto body = mesh::with_order(
      mesh::layered(mesh::Plate{.length = 0.3, .width = 0.2, .thickness = 0.02}, 0.1, 1), 2);
  const mesh::SiteFinder finder(body);
  const auto site = [&](double x, double y) { return finder.from_above(x, y).value(); };
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  std::vector<Attachment> attachments{
      {"to ground", site(0.02, 0.03), 0.0, GroundSpring{z, 0.0, 30.0}},
      {"between", site(-0.1, 0.0), 0.0, LinkSpring{site(0.1, 0.05), z, 0.0, 80.0}},
      {"absorber", site(0.1, -0.08), 0.0, Resonator{z, 0.02, 2e4, 3.0}}};
  std::vector<Support> supports;
  if (held) supports.push_back({.patch = "x_min", .x = true, .y = true, .z = true});
  Structure result;
  result.system = assemble(body, {isotropic(70e9, 0.33, 2700.0)}, supports, attachments);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      full_matrix(result.system.stiffness), full_matrix(result.system.mass));
  result.eigenvalues = solver.eigenvalues();
  result.shapes = solver.eigenvectors();
  result.rigid_count = held ? 0 : 6;
  std::vector<Eigen::SparseVector<double>> rows;
  for (const auto& [x, y] : {std::pair{0.14, 0.09}, {-0.13, 0.08}, {0.0, 0.0}, {0.12, -0.09}}) {
    rows.push_back(mesh::row_at(site(x, y), z, body.node_count()));
  }
  result.channels = columns_on_free(result.system.dofs, rows);
  return result;
}

class Reduced : public ::testing::TestWithParam<bool> {
 protected:
  static const Structure& of(bool held) {
    static const Structure free = structure(false);
    static const Structure clamped = structure(true);
    return held ? clamped : free;
  }
  const Structure& plate_ = of(GetParam());
};

TEST_P(Reduced, ResidualFlexibilityIsTheSumOverTheModesLeftOut) {
  for (const Eigen::Index kept : {10, 25}) {
    const auto found = residual_flexibility(plate_.system, plate_.modes(kept), plate_.channels);
    const auto rest = plate_.shapes.rightCols(plate_.shapes.cols() - kept);
    const Eigen::VectorXd lambda = plate_.eigenvalues.tail(rest.cols());
    const Eigen::MatrixXd expected =
        rest * (lambda.cwiseInverse().asDiagonal() * (rest.transpose() * plate_.channels));
    EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm()) << kept << " modes kept";
  }
}

TEST_P(Reduced, RespondsAsTheDirectSolutionDoesWellBelowItsLastMode) {
  const auto model = reduced(plate_.system, plate_.modes(60), plate_.channels, plate_.channels);
  EXPECT_EQ(model.damper_count(), 3);
  auto truncated = model;
  truncated.residual.setZero();
  // Not lower: the direct solution of a free body is all inertia there, and loses the flexibility.
  const double f = 1e-2 * model.frequency_hz(59);
  const Eigen::VectorXd line = Eigen::VectorXd::Constant(1, f);
  const auto expected = plate_.direct(f);
  const double with = (modal::frf(model, line).value[0] - expected).norm();
  const double without = (modal::frf(truncated, line).value[0] - expected).norm();
  EXPECT_LT(with, 1e-5 * expected.norm());
  EXPECT_LT(with, 1e-2 * without);
  EXPECT_GT(without, 0.1 * model.residual.norm());
}

TEST_P(Reduced, RespondsAsTheDirectSolutionDoesAtItsResonances) {
  const auto model = reduced(plate_.system, plate_.modes(40), plate_.channels, plate_.channels);
  auto truncated = model;
  truncated.residual.setZero();
  truncated.dampers.to_outputs.setZero();
  truncated.dampers.from_inputs.setZero();
  truncated.dampers.among.setZero();
  double with = 0.0;
  double without = 0.0;
  for (const Eigen::Index k : {6, 7, 8}) {
    const double f = 1.001 * model.frequency_hz(k);
    const auto expected = plate_.direct(f);
    const Eigen::VectorXd line = Eigen::VectorXd::Constant(1, f);
    with = std::max(with, (modal::frf(model, line).value[0] - expected).norm() / expected.norm());
    without = std::max(without,
                       (modal::frf(truncated, line).value[0] - expected).norm() / expected.norm());
  }
  EXPECT_LT(with, 5e-3);
  EXPECT_LT(with, 0.2 * without);
}

TEST_P(Reduced, IsReciprocal) {
  const auto model = reduced(plate_.system, plate_.modes(12), plate_.channels, plate_.channels);
  EXPECT_LT((model.residual - model.residual.transpose()).norm(), 1e-8 * model.residual.norm());
  EXPECT_TRUE(model.output_shapes.isApprox(model.input_shapes.transpose(), 1e-14));
}

INSTANTIATE_TEST_SUITE_P(FreeAndClamped, Reduced, ::testing::Bool());

TEST(Dashpots, GiveBackTheDampingMatrix) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(30, 3);
  d(3, 0) = 2.0;
  d(4, 0) = -1.0;
  d(4, 1) = 1e-3;  // shares a place with the first, and is a thousand times weaker
  d(9, 1) = 2e-3;
  d(20, 2) = 50.0;
  const Eigen::MatrixXd c = d * d.transpose();
  const SparseMatrix lower = Eigen::MatrixXd(c.triangularView<Eigen::Lower>()).sparseView();
  const auto found = dashpots(lower);
  EXPECT_EQ(found.cols(), 3);
  EXPECT_LT((Eigen::MatrixXd(found * found.transpose()) - c).norm(), 1e-13 * c.norm());
  // The weak one too, relative to itself.
  EXPECT_NEAR(Eigen::MatrixXd(found * found.transpose())(9, 9), 4e-6, 1e-18);
}

TEST(Dashpots, RefuseWhatMakesEnergy) {
  SparseMatrix c(2, 2);
  c.insert(0, 0) = 1.0;
  c.insert(1, 0) = 2.0;
  c.insert(1, 1) = 1.0;
  EXPECT_THROW((void)dashpots(c), InvalidInput);
  SparseMatrix negative(2, 2);
  negative.insert(1, 1) = -1.0;
  EXPECT_THROW((void)dashpots(negative), InvalidInput);
}

TEST(ReducedModel, RefusesModesOfAnotherSystem) {
  const auto plate = structure(false);
  auto scaled = plate.modes(10);
  scaled.shapes *= 2.0;
  EXPECT_THROW((void)reduced(plate.system, scaled, plate.channels, plate.channels), InvalidInput);
  auto shorter = plate.modes(10);
  shorter.shapes.conservativeResize(50, Eigen::NoChange);
  EXPECT_THROW((void)reduced(plate.system, shorter, plate.channels, plate.channels), InvalidInput);
}

TEST(ReducedModel, ChannelsLeaveHeldDegreesOfFreedomOut) {
  DofMap dofs{.free_dof = Eigen::VectorXi(6), .free_count = 4, .node_count = 2};
  dofs.free_dof << 0, -1, 1, 2, -1, 3;
  Eigen::SparseVector<double> row(6);
  row.insert(1) = 0.25;
  row.insert(3) = 0.5;
  row.insert(5) = 0.75;
  const auto found = Eigen::MatrixXd(columns_on_free(dofs, {row}));
  EXPECT_TRUE(found.isApprox(Eigen::Vector4d(0.0, 0.0, 0.5, 0.75)));
  EXPECT_THROW((void)columns_on_free(dofs, {Eigen::SparseVector<double>(7)}), InvalidInput);
}

}  // namespace
}  // namespace chladni::fem
