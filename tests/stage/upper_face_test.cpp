#include "stage/reduction/upper_face.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/material.h"
#include "mesh/bodies.h"
#include "stage/reduction/body_cells.h"

namespace chladni::stage {
namespace {

TEST(UpperFace, StandsOnItsShortestSide) {
  // A plate in the plane of y and z whose shapes are linear there.
  auto body = mesh::layered(mesh::Plate{.length = 0.3, .width = 0.2, .thickness = 0.01}, 0.05, 1);
  const Points lying = body.points;
  body.points << lying.col(2), lying.col(0), lying.col(1);
  const auto chart = stage::chart_of(body);
  EXPECT_EQ(chart.axes.col(2), Eigen::Vector3d::UnitX());
  EXPECT_NEAR(chart.size(0), 0.3, 1e-12);
  Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(3 * body.node_count(), 1);
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    shapes(3 * i, 0) = 1.0 + 2.0 * body.points(i, 1) - 3.0 * body.points(i, 2);
  }
  const stage::UpperFace face(chart, body, shapes);
  for (const double u : {-0.15, -0.04, 0.0, 0.15}) {
    const auto motion = face.at({u, 0.07});
    ASSERT_TRUE(motion.has_value()) << u;
    EXPECT_NEAR(motion->shape(0), 1.0 + 2.0 * u - 0.21, 1e-12);
    EXPECT_NEAR(motion->slope_u(0), 2.0, 1e-8);
    EXPECT_NEAR(motion->slope_v(0), -3.0, 1e-8);
  }
  EXPECT_EQ(stage::coverage(chart, face, {3, 2}), Eigen::MatrixXd::Ones(3, 2));
}

// A wedge, whose top lies below the plane of the chart but for one end.
TEST(UpperFace, TellsHowFarBelowTheChartTheBodyIs) {
  auto body = mesh::layered(mesh::Plate{.length = 0.3, .width = 0.2, .thickness = 0.1}, 0.05, 1);
  for (auto point : body.points.rowwise()) {
    if (point(2) > -0.01) point(2) -= 0.1 * (0.15 - point(0));
  }
  const auto chart = stage::chart_along(body, Eigen::Vector3d::UnitZ());
  const stage::UpperFace face(chart, body, Eigen::MatrixXd(3 * body.node_count(), 0));
  for (const double x : {-0.1, 0.0, 0.12}) {
    const auto height = face.height({x, 0.03});
    ASSERT_TRUE(height.has_value());
    EXPECT_NEAR(*height, -0.1 * (0.15 - x), 1e-9);
  }
  EXPECT_FALSE(face.height({0.2, 0.0}).has_value());
}

// A plate whose mesh is fine up to x = `border` and coarse beyond it, of 60 columns: `fine` of them
// are up to there.
Model graded_plate(int fine, double border) {
  constexpr double kHalf = 0.15;
  Model model;
  model.body = mesh::layered(mesh::Plate{.length = 0.3, .width = 0.2, .thickness = 0.01}, 0.005, 1);
  const double from = -kHalf + 0.005 * fine;
  for (auto& x : model.body.points.col(0)) {
    x = x <= from ? -kHalf + (x + kHalf) * (border + kHalf) / (from + kHalf)
                  : kHalf - (kHalf - x) * (kHalf - border) / (kHalf - from);
  }
  model.materials = {fem::isotropic(70e9, 0.33, 2700.0)};
  return model;
}

diagnosis::BodyCells cells_on_translations(const Model& model) {
  modal::Modes modes;
  modes.frequency_hz = Eigen::VectorXd::Zero(3);
  modes.shapes = Eigen::Matrix3d::Identity().replicate(model.body.node_count(), 1);
  modes.rigid_count = 3;
  const auto chart = chart_of(model.body);
  const UpperFace face(chart, model.body, modes.shapes);
  return cells_of(model, modes, chart, face, false);
}

// The middle of a cell is that of its volume, also where half of it has four times the elements.
TEST(BodyCells, HaveTheirMiddlesWhereverTheMeshIsFine) {
  const auto even = cells_on_translations(graded_plate(30, 0.0));
  const auto graded = cells_on_translations(graded_plate(48, 0.0125));
  ASSERT_EQ(even.count(), graded.count());
  const double pitch = std::sqrt(0.3 * 0.2 / static_cast<double>(even.count()));
  EXPECT_LT((even.centres - graded.centres).cwiseAbs().maxCoeff(), 0.05 * pitch);
  for (Eigen::Index c = 0; c < even.count(); ++c) {
    const auto& mass = graded.mass[static_cast<std::size_t>(c)];
    EXPECT_NEAR(mass(2, 2), even.mass[static_cast<std::size_t>(c)](2, 2), 0.05 * mass(2, 2)) << c;
  }
}

}  // namespace
}  // namespace chladni::stage
