#include "fem/assemble.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <random>

#include "base/error.h"
#include "fem/element/element_matrices.h"
#include "fem/modes.h"
#include "host/parallel.h"
#include "mesh/bodies.h"

namespace chladni::fem {
namespace {

const Material kAluminium = isotropic(70e9, 0.33, 2700.0);

mesh::TetMesh block(int order) {
  return mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.1}, 0.1, 1), order);
}

Eigen::MatrixXd full(const SparseMatrix& lower) {
  const SparseMatrix both = lower.selfadjointView<Eigen::Lower>();
  return Eigen::MatrixXd(both);
}

class AnyOrder : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Fem, AnyOrder, testing::Values(1, 2, 3));

// The same sum by triplets and full loops.
TEST_P(AnyOrder, SumsTheElementMatrices) {
  const auto body = block(GetParam());
  const auto system = assemble(body, {kAluminium});
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * body.node_count(), 3 * body.node_count());
  Eigen::MatrixXd m = k;
  ElementIntegrator integrator(body, {kAluminium});
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    const auto& cell = integrator.matrices(t);
    Eigen::Index pair = 0;
    for (Eigen::Index a = 0; a < body.tets.cols(); ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
        for (Eigen::Index i = 0; i < 3; ++i) {
          const auto row = 3 * Eigen::Index{body.tets(t, a)} + i;
          for (Eigen::Index j = 0; j < 3; ++j) {
            const auto column = 3 * Eigen::Index{body.tets(t, b)} + j;
            k(row, column) += cell.stiffness(pair, 3 * i + j);
            if (a != b) k(column, row) += cell.stiffness(pair, 3 * i + j);
          }
          const auto column = 3 * Eigen::Index{body.tets(t, b)} + i;
          m(row, column) += cell.mass(pair);
          if (a != b) m(column, row) += cell.mass(pair);
        }
      }
    }
  }
  EXPECT_LT((full(system.stiffness) - k).norm(), 1e-13 * k.norm());
  EXPECT_LT((full(system.mass) - m).norm(), 1e-13 * m.norm());
}

TEST_P(AnyOrder, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto body = block(GetParam());
  set_thread_count(1);
  const auto one = assemble(body, {kAluminium});
  for (const int threads : {2, 3}) {
    set_thread_count(threads);
    const auto more = assemble(body, {kAluminium});
    ASSERT_EQ(one.stiffness.nonZeros(), more.stiffness.nonZeros());
    EXPECT_TRUE(std::equal(one.stiffness.valuePtr(),
                           one.stiffness.valuePtr() + one.stiffness.nonZeros(),
                           more.stiffness.valuePtr()));
    EXPECT_TRUE(std::equal(one.mass.valuePtr(), one.mass.valuePtr() + one.mass.nonZeros(),
                           more.mass.valuePtr()));
  }
  set_thread_count(2);
}

TEST_P(AnyOrder, MovesRigidlyAtNoCost) {
  const auto system = assemble(block(GetParam()), {kAluminium});
  ASSERT_EQ(system.rigid.cols(), 6);
  const Eigen::MatrixXd force = system.stiffness.selfadjointView<Eigen::Lower>() * system.rigid;
  EXPECT_LT(force.cwiseAbs().maxCoeff(),
            1e-13 * system.stiffness.diagonal().maxCoeff() * system.rigid.cwiseAbs().maxCoeff());
  const Eigen::MatrixXd m = system.mass.selfadjointView<Eigen::Lower>() * system.rigid;
  EXPECT_LT((system.rigid.transpose() * m - Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-12);
}

// Inside a patch under constant strain no node is pushed, however distorted the cells are.
TEST(Assemble, PassesTheLinearPatchTestOnADistortedPatch) {
  for (const int order : {1, 2, 3}) {
    auto body = block(1);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> shift(-0.004, 0.004);
    for (Eigen::Index i = 0; i < body.points.size(); ++i) body.points.data()[i] += shift(random);
    body = mesh::with_order(body, order);
    const auto system = assemble(body, {kAluminium});
    Eigen::Matrix3d g;
    g << 1, 2, 3, 4, 5, 6, 7, 8, 10;
    Eigen::VectorXd u(3 * body.node_count());
    for (Eigen::Index i = 0; i < body.node_count(); ++i) {
      u.segment<3>(3 * i) = g * body.points.row(i).transpose();
    }
    Eigen::VectorXd force = system.stiffness.selfadjointView<Eigen::Lower>() * u;
    const double largest = force.cwiseAbs().maxCoeff();
    std::vector<char> on_boundary(static_cast<std::size_t>(body.node_count()), 0);
    for (const auto node : body.faces.reshaped()) on_boundary[static_cast<std::size_t>(node)] = 1;
    for (Eigen::Index i = 0; i < body.node_count(); ++i) {
      if (on_boundary[static_cast<std::size_t>(i)] == 0) {
        EXPECT_LT(force.segment<3>(3 * i).cwiseAbs().maxCoeff(), 1e-11 * largest);
      }
    }
  }
}

TEST(MassProperties, AreThoseOfABox) {
  const auto body = block(2);
  const auto found = mass_properties(body, {kAluminium});
  const double m = 2700.0 * 0.3 * 0.2 * 0.1;
  EXPECT_NEAR(found.mass_kg / m, 1.0, 1e-12);
  EXPECT_LT((found.centre_m - Eigen::Vector3d(0, 0, -0.05)).norm(), 1e-14);
  const Eigen::Vector3d expected =
      m / 12.0 *
      Eigen::Vector3d(0.2 * 0.2 + 0.1 * 0.1, 0.3 * 0.3 + 0.1 * 0.1, 0.3 * 0.3 + 0.2 * 0.2);
  EXPECT_LT((found.inertia_kg_m2.diagonal() - expected).norm(), 1e-12 * expected.norm());
}

TEST(MassProperties, AreThoseOfABallWithCurvedCells) {
  const mesh::Sphere ball{.diameter = 0.2};
  auto body = mesh::with_order(mesh::layered(ball, 0.03), 2);
  mesh::project_to_sphere(body, ball);
  const auto found = mass_properties(body, {kAluminium});
  const double m = 2700.0 * 4.0 / 3.0 * 3.14159265358979 * 1e-3;
  EXPECT_NEAR(found.mass_kg / m, 1.0, 2e-4);
  EXPECT_NEAR(found.inertia_kg_m2(0, 0) / (0.4 * m * 0.01), 1.0, 4e-4);
}

TEST(Supports, TakeTheirDegreesOfFreedomAndLeaveTheRigidMotionsTheyAllow) {
  const auto body = block(2);
  const auto guided = assemble(body, {kAluminium}, {{.patch = "x_min", .z = true}});
  EXPECT_EQ(guided.rigid.cols(), 4);  // x, y, about z, and about the held face's own line
  const auto clamped =
      assemble(body, {kAluminium}, {{.patch = "x_min", .x = true, .y = true, .z = true}});
  EXPECT_EQ(clamped.rigid.cols(), 0);
  EXPECT_LT(clamped.dofs.free_count, 3 * body.node_count());
  try {
    (void)assemble(body, {kAluminium}, {{.patch = "left"}});
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("x_min"), std::string::npos) << e.what();
  }
}

TEST(Supports, OnAPatchWithoutFacesAreRefused) {
  auto body = block(1);
  body.patch_names.emplace_back("interface");  // between two regions
  try {
    (void)assemble(body, {kAluminium}, {{.patch = "interface", .x = true}});
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("\"interface\" has no face"), std::string::npos)
        << e.what();
  }
}

TEST(Assemble, RefusesABodyWithoutMaterial) {
  EXPECT_THROW((void)assemble(block(1), {}), InvalidInput);
}

}  // namespace
}  // namespace chladni::fem
