#include "fem/error_estimate.h"

#include <gtest/gtest.h>

#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"

namespace chladni::fem {
namespace {

struct Case {
  int order;
  double edge;
};

// Exact 3D elasticity of the free 600 x 600 x 20 mm plate (Legendre Ritz, docs/reference).
constexpr double kExact[] = {178.9033, 264.0703, 334.3557, 463.3912, 463.3912,
                             828.3701, 828.3701, 841.9149, 917.1476, 1037.6694};

class EstimateOfAPlate : public testing::TestWithParam<Case> {};

TEST_P(EstimateOfAPlate, IsWithinAFactorOfTheTrueError) {
  const auto [order, edge] = GetParam();
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, edge, 1), order);
  const std::vector<Material> materials{isotropic(70e9, 0.33, 2700.0)};
  const auto system = assemble(body, materials);
  const auto found = modes(system, {.count = 10}).modes;
  const auto estimate = frequency_error(body, materials, system, found);
  EXPECT_TRUE((estimate.head(6).array() == 0.0).all());
  for (Eigen::Index i = 0; i < 10; ++i) {
    const double truth = 1.0 - kExact[i] / found.frequency_hz(6 + i);
    RecordProperty("ratio_" + std::to_string(i), std::to_string(estimate(6 + i) / truth));
    EXPECT_GT(estimate(6 + i), truth / 3.0) << "flexible mode " << i + 1 << " error " << truth;
    EXPECT_LT(estimate(6 + i), truth * 6.0) << "flexible mode " << i + 1 << " error " << truth;
  }
}

INSTANTIATE_TEST_SUITE_P(Fem, EstimateOfAPlate,
                         testing::Values(Case{2, 0.05}, Case{2, 0.03}, Case{3, 0.1},
                                         Case{3, 0.05}));

TEST(Estimate, FallsWithTheMesh) {
  const std::vector<Material> materials{isotropic(70e9, 0.33, 2700.0)};
  double before = 1.0;
  for (const double edge : {0.1, 0.05, 0.025}) {
    const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, edge, 1), 2);
    const auto system = assemble(body, materials);
    const auto found = modes(system, {.count = 3}).modes;
    const double now = frequency_error(body, materials, system, found)(6);
    EXPECT_LT(now, before);
    before = now;
  }
}

}  // namespace
}  // namespace chladni::fem
