#include "fem/field_matrices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "fem/assemble.h"
#include "fem/modes.h"
#include "host/parallel.h"
#include "mesh/bodies.h"
#include "peak_memory.h"

namespace chladni::fem {
namespace {

const std::vector<Material> kPlateMaterials{isotropic(70e9, 0.33, 2700.0)};

class FieldMatricesOf : public ::testing::TestWithParam<int> {
 protected:
  mesh::TetMesh body_ = mesh::with_order(
      mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, GetParam() == 3 ? 0.1 : 0.05, 1), GetParam());
  System system_ = assemble(body_, kPlateMaterials);
  modal::Modes modes_ = modes(system_, {.count = 5, .certificate = false}).modes;
  Eigen::MatrixXd shapes_ = on_nodes(system_.dofs, modes_.shapes);

  [[nodiscard]] Eigen::MatrixXd field(double left, double right) const {
    Eigen::MatrixXd values(body_.tet_count(), 1);
    for (Eigen::Index t = 0; t < values.rows(); ++t) {
      double x = 0.0;
      for (int a = 0; a < 4; ++a) x += 0.25 * body_.points(body_.tets(t, a), 0);
      values(t) = x < 0.0 ? left : right;
    }
    return values;
  }
};

TEST_P(FieldMatricesOf, OnesGiveTheEigenvaluesAndTheIdentity) {
  const auto found = field_matrices(body_, kPlateMaterials, shapes_, field(1, 1), field(1, 1));
  const Eigen::VectorXd lambda = (2.0 * std::numbers::pi * modes_.frequency_hz).cwiseAbs2();
  const double scale = lambda.maxCoeff();
  EXPECT_LT((found.stiffness[0] - Eigen::MatrixXd(lambda.asDiagonal())).cwiseAbs().maxCoeff(),
            1e-8 * scale);
  EXPECT_TRUE(found.mass[0].isIdentity(1e-9));
}

TEST_P(FieldMatricesOf, HalvesAddUpToTheWhole) {
  Eigen::MatrixXd fields(body_.tet_count(), 3);
  fields << field(1, 0), field(0, 1), field(1, 1);
  const auto found = field_matrices(body_, kPlateMaterials, shapes_, fields, fields);
  EXPECT_TRUE((found.stiffness[0] + found.stiffness[1]).isApprox(found.stiffness[2], 1e-12));
  EXPECT_TRUE((found.mass[0] + found.mass[1]).isApprox(found.mass[2], 1e-12));
}

// A first-order change of an eigenvalue is what a changed body has.
TEST_P(FieldMatricesOf, PredictWhatAnotherMaterialDoes) {
  const double change = 1e-4;
  auto parts = body_;
  parts.region_names = {"left", "right"};
  const Eigen::MatrixXd right = field(0, 1);
  parts.region = right.col(0).cast<int>();
  const auto changed = assemble(
      parts, {isotropic(70e9, 0.33, 2700.0), isotropic(70e9 * (1 + change), 0.33, 2700.0)});
  const auto after = modes(changed, {.count = 5, .certificate = false}).modes;
  const auto found = field_matrices(body_, kPlateMaterials, shapes_, right, right);
  for (Eigen::Index i = 6; i < 10; ++i) {
    const double before = std::pow(2.0 * std::numbers::pi * modes_.frequency_hz(i), 2);
    const double now = std::pow(2.0 * std::numbers::pi * after.frequency_hz(i), 2);
    EXPECT_NEAR((now - before) / (change * found.stiffness[0](i, i)), 1.0, 0.01) << "mode " << i;
  }
}

TEST_P(FieldMatricesOf, DoNotDependOnTheNumberOfThreads) {
  const int threads = thread_count();
  const auto all = field_matrices(body_, kPlateMaterials, shapes_, field(1, 2), field(2, 1));
  set_thread_count(1);
  const auto one = field_matrices(body_, kPlateMaterials, shapes_, field(1, 2), field(2, 1));
  set_thread_count(threads);
  EXPECT_EQ(all.stiffness[0], one.stiffness[0]);
  EXPECT_EQ(all.mass[0], one.mass[0]);
}

INSTANTIATE_TEST_SUITE_P(EveryOrder, FieldMatricesOf, ::testing::Values(1, 2, 3));

TEST(FieldMatrices, RefuseAFieldOfAnotherMesh) {
  const auto body = mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, 0.1, 1);
  const Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(3 * body.node_count(), 2);
  const Eigen::MatrixXd good = Eigen::MatrixXd::Ones(body.tet_count(), 1);
  EXPECT_THROW((void)field_matrices(body, kPlateMaterials, shapes, good.topRows(3), good),
               InvalidInput);
  EXPECT_THROW((void)field_matrices(body, kPlateMaterials, shapes.topRows(6), good, good),
               InvalidInput);
}

TEST(FieldMatrices, TakeTheMemoryThatTheyForecast) {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, 0.02, 1), 2);
  const Eigen::Index m = 40;
  const Eigen::Index fields = 60;
  const Eigen::MatrixXd shapes = Eigen::MatrixXd::Random(3 * body.points.rows(), m);
  const Eigen::MatrixXd values = Eigen::MatrixXd::Random(body.tet_count(), fields);
  const auto peak = peak_of([&] {
    const auto found = field_matrices(body, kPlateMaterials, shapes, values, values);
    const bool sound = found.mass.size() == static_cast<std::size_t>(fields);
    return sound ? 34.0 * 2.0 * static_cast<double>(fields * m * m) * sizeof(double) : 0.0;
  });
  ASSERT_GT(peak.forecast, 1e7);
  EXPECT_LT(peak.used, 1.1 * peak.forecast + 8e6);  // libraries and small vectors
  EXPECT_GT(peak.used, 0.6 * peak.forecast);
  RecordProperty("used_over_forecast", std::to_string(peak.used / peak.forecast));
}

}  // namespace
}  // namespace chladni::fem
