#include "io/figure/skin.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "base/error.h"
#include "mesh/bodies.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

constexpr double kLength = 0.3, kWidth = 0.2, kThickness = 0.02;

mesh::TetMesh skin_plate(int order, double edge = 0.05) {
  return with_order(mesh::layered(mesh::Plate{kLength, kWidth, kThickness}, edge, 1), order);
}

double enclosed(const Skin& skin, const Points& at) {
  double volume = 0.0;
  for (const auto t : skin.triangles.rowwise()) {
    volume += at.row(t(0)).dot(at.row(t(1)).cross(at.row(t(2)))) / 6.0;
  }
  return volume;
}

double length(const Cells& lines, const Points& at) {
  double sum = 0.0;
  for (const auto line : lines.rowwise()) sum += (at.row(line(0)) - at.row(line(1))).norm();
  return sum;
}

Eigen::Index edge_count(const Cells& triangles) {
  std::set<std::pair<int, int>> edges;
  for (const auto t : triangles.rowwise()) {
    for (int a = 0; a < 3; ++a) edges.insert(std::minmax(t(a), t((a + 1) % 3)));
  }
  return static_cast<Eigen::Index>(edges.size());
}

TEST(Skin, IsClosedAndEnclosesTheBodyWhateverTheDivisions) {
  for (const int order : {1, 2, 3}) {
    const mesh::TetMesh mesh = skin_plate(order);
    for (const int divisions : {1, 2, 3, 5}) {
      const Skin body = skin(mesh, divisions);
      const Points at = vertices(body, mesh.points);
      EXPECT_EQ(body.triangles.rows(), mesh.faces.rows() * divisions * divisions);
      EXPECT_NEAR(enclosed(body, at), kLength * kWidth * kThickness, 1e-15);
      EXPECT_EQ(body.vertex_count() - edge_count(body.triangles) + body.triangles.rows(), 2);
    }
  }
}

TEST(Skin, TheOutlineOfABoxIsItsTwelveEdges) {
  for (const int order : {1, 3}) {
    const mesh::TetMesh mesh = skin_plate(order);
    const Skin body = skin(mesh, 4);
    EXPECT_NEAR(length(body.outline, vertices(body, mesh.points)),
                4.0 * (kLength + kWidth + kThickness), 1e-12);
  }
}

TEST(Skin, APolynomialOfTheMeshesOrderIsExactBetweenTheNodes) {
  for (const int order : {1, 2, 3}) {
    const mesh::TetMesh mesh = skin_plate(order);
    const Skin body = skin(mesh, 5);
    const auto field = [&](const Points& points) {
      Points values(points.rows(), 3);
      for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const double s = points.row(i).dot(Eigen::RowVector3d(1.0, -2.0, 0.5));
        values.row(i) << std::pow(s, order), 1.0, std::pow(points(i, 0), order) - s;
      }
      return values;
    };
    const Points nodal = field(mesh.points);
    const Points seen =
        field_at(body, Eigen::Map<const Eigen::VectorXd>(nodal.data(), nodal.size()));
    EXPECT_LT((seen - field(vertices(body, mesh.points))).cwiseAbs().maxCoeff(), 1e-14) << order;
  }
}

TEST(Skin, PatchesFollowTheirFaces) {
  const mesh::TetMesh mesh = skin_plate(2);
  const Skin body = skin(mesh, 3);
  const Points at = vertices(body, mesh.points);
  for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
    const auto& name = mesh.patch_names[static_cast<std::size_t>(body.patch(t))];
    for (const auto v : body.triangles.row(t)) {
      if (name == "top") EXPECT_NEAR(at(v, 2), 0.0, 1e-15);
      if (name == "x_max") EXPECT_NEAR(at(v, 0), kLength / 2, 1e-15);
    }
  }
}

TEST(Skin, ASmoothOneHasTheDivisionsThatItsBudgetAllows) {
  const mesh::TetMesh mesh = skin_plate(2);
  EXPECT_EQ(smooth_skin(mesh, 1'000'000).triangles.rows(), mesh.faces.rows() * 64);
  EXPECT_EQ(smooth_skin(mesh, 10).triangles.rows(), mesh.faces.rows() * 4);
  const Skin body = smooth_skin(mesh, 8 * mesh.faces.rows());
  EXPECT_LE(body.vertex_count(), 8 * mesh.faces.rows() + 2);
  EXPECT_EQ(body.triangles.rows(), mesh.faces.rows() * 16);
}

TEST(Skin, ADecimatedOneIsSmallAndKeepsTheBodysShape) {
  const mesh::TetMesh mesh = skin_plate(2, 0.01);
  const Skin whole = skin(mesh, 2);
  for (const Eigen::Index most : {2000, 600, 200}) {
    const Skin body = decimated(whole, mesh.points, most);
    const Points at = vertices(body, mesh.points);
    EXPECT_LE(body.vertex_count(), most);
    EXPECT_GT(body.vertex_count(), most / 4);
    EXPECT_NEAR(enclosed(body, at), kLength * kWidth * kThickness,
                0.15 * kLength * kWidth * kThickness);
    EXPECT_LT(body.triangles.maxCoeff(), body.vertex_count());
    EXPECT_LT(body.outline.maxCoeff(), body.vertex_count());
  }
  EXPECT_EQ(decimated(whole, mesh.points, whole.vertex_count()).triangles, whole.triangles);
}

TEST(Skin, ADecimatedOneStandsOnVerticesOfTheWhole) {
  const mesh::TetMesh mesh = skin_plate(2, 0.02);
  const Skin whole = skin(mesh, 2);
  const Skin body = decimated(whole, mesh.points, 150);
  const Points at = vertices(body, mesh.points), all = vertices(whole, mesh.points);
  for (const auto vertex : at.rowwise()) {
    EXPECT_EQ((all.rowwise() - vertex).rowwise().norm().minCoeff(), 0.0);
  }
}

TEST(Skin, MorePatchesThanVerticesStillEnd) {
  mesh::TetMesh mesh = skin_plate(1, 0.02);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) mesh.face_patch(f) = static_cast<int>(f);
  EXPECT_LE(decimated(skin(mesh, 1), mesh.points, 8).vertex_count(), 8);
}

TEST(Skin, ImpossibleNumbersAreRefused) {
  const mesh::TetMesh mesh = skin_plate(1);
  EXPECT_THROW(static_cast<void>(skin(mesh, 0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(skin(mesh, 17)), InvalidInput);
  EXPECT_THROW(static_cast<void>(decimated(skin(mesh, 1), mesh.points, 7)), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
