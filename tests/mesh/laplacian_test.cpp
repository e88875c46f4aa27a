#include "mesh/laplacian.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/error.h"
#include "mesh/bodies.h"

namespace chladni::mesh {
namespace {

Eigen::VectorXd times(const SparseMatrix& lower, const Eigen::VectorXd& x) {
  return lower.selfadjointView<Eigen::Lower>() * x;
}

TetMesh plate_of_order(int order) {
  return with_order(layered(Plate{0.6, 0.4, 0.05}, 0.1, 1), order);
}

class OfEveryOrder : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, OfEveryOrder, testing::Values(1, 2, 3));

TEST_P(OfEveryOrder, ConstantsCostNothingAndWeighTheArea) {
  const auto mesh = plate_of_order(GetParam());
  const auto whole = surface_laplacian(mesh);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(whole.mass.rows());
  EXPECT_LT(times(whole.stiffness, one).norm(), 1e-10);
  EXPECT_NEAR(one.dot(times(whole.mass, one)), 2.0 * (0.24 + 0.03 + 0.02), 1e-12);
  const auto body = body_laplacian(mesh);
  const Eigen::VectorXd all = Eigen::VectorXd::Ones(body.mass.rows());
  EXPECT_LT(times(body.stiffness, all).norm(), 1e-12);
  EXPECT_NEAR(all.dot(times(body.mass, all)), 0.6 * 0.4 * 0.05, 1e-14);
}

// Linear functions are met exactly: ∫|∇f|² = |a|² times the area, ∫f² by hand.
TEST_P(OfEveryOrder, LinearFunctionsAreExact) {
  const auto mesh = plate_of_order(GetParam());
  const auto top = surface_laplacian(mesh, {"top"});
  const Eigen::VectorXd f = 3.0 * top.positions.col(0) - 2.0 * top.positions.col(1);
  EXPECT_NEAR(f.dot(times(top.stiffness, f)), 13.0 * 0.24, 1e-10);
  EXPECT_NEAR(f.dot(times(top.mass, f)), 0.24 * (9.0 * 0.36 + 4.0 * 0.16) / 12.0, 1e-12);
  const auto body = body_laplacian(mesh);
  const Eigen::VectorXd g = body.positions * Eigen::Vector3d(3.0, -2.0, 1.0);
  EXPECT_NEAR(g.dot(times(body.stiffness, g)), 14.0 * 0.012, 1e-12);
}

TEST_P(OfEveryOrder, PointsComeBackOnTheNodesTheyAreFrom) {
  const auto mesh = plate_of_order(GetParam());
  const auto top = surface_laplacian(mesh, {"top"});
  const Eigen::MatrixXd on_top = top.on_nodes * Eigen::MatrixXd(top.positions);
  for (Eigen::Index n = 0; n < mesh.node_count(); ++n) {
    if (mesh.points(n, 2) == 0.0) {
      EXPECT_LT((on_top.row(n) - mesh.points.row(n)).norm(), 1e-14);
    } else {
      EXPECT_EQ(on_top.row(n).norm(), 0.0);
    }
  }
  const auto body = body_laplacian(mesh);
  const Eigen::MatrixXd everywhere = body.on_nodes * Eigen::MatrixXd(body.positions);
  EXPECT_LT((everywhere - mesh.points).norm(), 1e-12);
}

TEST(Laplacian, KnowsThePiecesOfASurface) {
  const auto hollow = layered(Sphere{0.4, 0.2}, 0.05);
  EXPECT_EQ(surface_laplacian(hollow).piece.maxCoeff(), 1);
  EXPECT_EQ(surface_laplacian(hollow, {"outer"}).piece.maxCoeff(), 0);
  EXPECT_EQ(body_laplacian(hollow).piece.maxCoeff(), 0);
}

TEST(Laplacian, MeetsCurvedFacesToSecondOrder) {
  const auto missing = [](double edge) {
    const Sphere sphere{0.4};
    auto mesh = with_order(layered(sphere, edge), 2);
    project_to_sphere(mesh, sphere);
    const auto whole = surface_laplacian(mesh);
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(whole.mass.rows());
    return std::numbers::pi * 0.16 - one.dot(times(whole.mass, one));
  };
  EXPECT_GT(missing(0.05), 0.0);
  EXPECT_NEAR(missing(0.1) / missing(0.05), 4.0, 0.3);
}

TEST(Laplacian, RefusesWhatCannotBeMeant) {
  auto mesh = plate_of_order(1);
  EXPECT_THROW((void)surface_laplacian(mesh, {"lid"}), InvalidInput);
  mesh.points.row(mesh.faces(0, 1)) = mesh.points.row(mesh.faces(0, 0));
  EXPECT_THROW((void)surface_laplacian(mesh), InvalidInput);
  EXPECT_THROW((void)body_laplacian(mesh), InvalidInput);
}

}  // namespace
}  // namespace chladni::mesh
