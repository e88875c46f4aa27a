#include "fem/error_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"
#include "peak_memory.h"

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
    EXPECT_GT(estimate(6 + i), truth * 1.0) << "flexible mode " << i + 1 << " error " << truth;
    EXPECT_LT(estimate(6 + i), truth * 3.0) << "flexible mode " << i + 1 << " error " << truth;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fem, EstimateOfAPlate,
    testing::Values(Case{2, 0.05}, Case{2, 0.03}, Case{3, 0.1}, Case{3, 0.05},
                    // Cells of 2, 4 and 8 thicknesses: it was 14 times the error.
                    Case{2, 0.04}, Case{2, 0.08}, Case{2, 0.16}));

// Lamb's free sphere (200 GPa, 0.3, 8000 kg/m^3, radius 0.1 m): curved cells.
struct Family {
  double hz;
  int size;
};
constexpr Family kSphere[] = {
    {12343.553, 5}, {13059.571, 5}, {17421.141, 3}, {19073.009, 7}, {19431.805, 7}};

class EstimateOfASphere : public testing::TestWithParam<Case> {};

TEST_P(EstimateOfASphere, IsWithinAFactorOfTheTrueError) {
  const auto [order, edge] = GetParam();
  const mesh::Sphere ball{.diameter = 0.2};
  auto body = mesh::with_order(mesh::layered(ball, edge), order);
  mesh::project_to_sphere(body, ball);
  const std::vector<Material> materials{isotropic(200e9, 0.3, 8000.0)};
  const auto system = assemble(body, materials);
  const auto found = modes(system, {.count = 27}).modes;
  const auto estimate = frequency_error(body, materials, system, found);
  Eigen::Index mode = 6;
  for (const auto& [hz, size] : kSphere) {
    // A ball of cubic cells is not quite the ball: its first family lies 3e-5 too low, of which an
    // estimate from the mode's residual knows nothing.
    const bool geometry_rules = order == 3 && hz == kSphere[0].hz;
    for (int i = 0; i < size; ++i, ++mode) {
      const double truth = 1.0 - hz / found.frequency_hz(mode);
      RecordProperty("ratio_" + std::to_string(mode), std::to_string(estimate(mode) / truth));
      if (geometry_rules) continue;
      EXPECT_GT(estimate(mode), truth * 1.0) << hz << " Hz, error " << truth;
      EXPECT_LT(estimate(mode), truth * 2.5) << hz << " Hz, error " << truth;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Fem, EstimateOfASphere,
                         testing::Values(Case{2, 0.05}, Case{2, 0.025}, Case{3, 0.05}));

// Estimate and error of each of `count` frequencies; `converged` is empty or the true ones.
struct Estimated {
  Eigen::VectorXd estimate, truth, frequency_hz;
};

Estimated estimated(const mesh::TetMesh& body, int count, const Eigen::VectorXd& converged) {
  const std::vector<Material> materials{isotropic(70e9, 0.33, 2700.0)};
  const auto system = assemble(body, materials);
  const auto found = modes(system, {.count = count}).modes;
  Estimated result;
  result.frequency_hz = found.frequency_hz.tail(count);
  result.estimate = frequency_error(body, materials, system, found).tail(count);
  if (converged.size() == count) {
    result.truth = 1.0 - converged.array() / result.frequency_hz.array();
  }
  return result;
}

void expect_within(const Estimated& found, double low, double high) {
  for (Eigen::Index i = 0; i < found.estimate.size(); ++i) {
    EXPECT_GT(found.estimate(i), low * found.truth(i)) << i + 1 << ", error " << found.truth(i);
    EXPECT_LT(found.estimate(i), high * found.truth(i)) << i + 1 << ", error " << found.truth(i);
  }
}

// Cells of 1, 2 and 4 thicknesses along a beam whose cubic cells leave a tenth of these errors.
TEST(Estimate, IsWithinAFactorOfTheTrueErrorOfABeam) {
  const mesh::Plate beam{0.6, 0.04, 0.02};
  const auto fine = estimated(mesh::with_order(mesh::layered(beam, 0.02, 1), 3), 8, {});
  for (const double edge : {0.02, 0.04, 0.08}) {
    SCOPED_TRACE(edge);
    const auto body = mesh::with_order(mesh::layered(beam, edge, 1), 2);
    expect_within(estimated(body, 8, fine.frequency_hz), 0.9, 3.0);
  }
}

// Cells of 6 to 30 thicknesses. The motions of a coarse mesh have another order, but for the first
// four. Where two cells span the beam, it was 0.04 of the error.
TEST(Estimate, IsAnUpperSideOfTheErrorOfABeamOfFewCells) {
  const mesh::Plate beam{0.6, 0.04, 0.02};
  const auto fine = estimated(mesh::with_order(mesh::layered(beam, 0.02, 1), 3), 8, {});
  for (const double edge : {0.12, 0.16, 0.3}) {
    SCOPED_TRACE(edge);
    const auto found =
        estimated(mesh::with_order(mesh::layered(beam, edge, 1), 2), 8, fine.frequency_hz);
    for (Eigen::Index i = 0; i < 4; ++i) {
      EXPECT_GT(found.estimate(i), (edge < 0.3 ? 1.0 : 0.6) * found.truth(i)) << i + 1;
      EXPECT_LT(found.estimate(i), 3.0 * found.truth(i)) << i + 1;
    }
    if (edge > 0.2) continue;
    EXPECT_GT(found.estimate.maxCoeff(), found.truth.maxCoeff());
  }
}

// Two layers that are bonded, the upper one a thousand times as stiff. The traction between them
// was taken as the mean of both sides, and the estimate was 9 to 30 times the error.
TEST(Estimate, IsWithinAFactorOfTheTrueErrorOfBondedLayers) {
  const std::vector<Material> materials{isotropic(70e6, 0.0, 2700.0), isotropic(70e9, 0.0, 2700.0)};
  const auto solved = [&](double edge, int order) {
    auto body = mesh::layered(mesh::Plate{0.4, 0.02, 0.01}, edge, 2);
    body.region_names = {"soft", "stiff"};
    for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
      const Eigen::Matrix<int, 1, 4> corner = body.tets.row(t).head<4>();
      body.region(t) = body.points(corner, 2).sum() > -0.02 ? 1 : 0;
    }
    body = mesh::with_order(body, order);
    const auto system = assemble(body, materials);
    const auto found = modes(system, {.count = 6}).modes;
    const Eigen::VectorXd error = frequency_error(body, materials, system, found);
    return std::pair(Eigen::VectorXd(found.frequency_hz.tail(6)), Eigen::VectorXd(error.tail(6)));
  };
  const auto fine = solved(0.02, 3);
  const auto [hz, estimate] = solved(0.04, 2);
  expect_within({estimate, 1.0 - fine.first.array() / hz.array(), hz}, 1.0, 3.0);
}

TEST(Estimate, IsWithinAFactorOfTheTrueErrorOfACube) {
  const mesh::Plate cube{0.1, 0.1, 0.1};
  const auto fine = estimated(mesh::with_order(mesh::layered(cube, 0.034, 3), 3), 8, {});
  for (const int order : {1, 2}) {
    SCOPED_TRACE(order);
    const auto body = mesh::with_order(mesh::layered(cube, 0.05, 2), order);
    expect_within(estimated(body, 8, fine.frequency_hz), 0.5, 3.0);
  }
}

// Flat linear cells cannot bend: frequencies 5 to 10 times too high were said to be 30 times so.
TEST(Estimate, IsLessThanTheWholeFrequency) {
  const auto found = estimated(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.16, 1), 8, {});
  EXPECT_LT(found.estimate.maxCoeff(), 1.0);
  EXPECT_GT(found.estimate.minCoeff(), 0.5);
}

// A body of an orthotropic material, turned as a whole.
TEST(Estimate, IsTheSameOfATurnedBody) {
  const auto material = orthotropic({.youngs_modulus = {140e9, 10e9, 10e9},
                                     .poissons_ratio = {0.4, 0.02, 0.3},
                                     .shear_modulus = {3.5e9, 5e9, 5e9}},
                                    1600.0);
  const auto of = [&](double angle) {
    const Eigen::Matrix3d axes =
        Eigen::AngleAxisd(angle, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
    auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, 0.06, 1), 2);
    body.points = body.points * axes.transpose();
    const std::vector<Material> materials{turned(material, axes)};
    const auto system = assemble(body, materials);
    const auto found = modes(system, {.count = 5}).modes;
    return Eigen::VectorXd(frequency_error(body, materials, system, found).tail(5));
  };
  const Eigen::VectorXd straight = of(0.0);
  EXPECT_LT((of(0.6) - straight).cwiseAbs().maxCoeff(), 1e-6 * straight.maxCoeff());
}

// Half as long cells leave a sixteenth of the error.
TEST(Estimate, FallsByTheOrderOfTheElements) {
  const mesh::Sphere ball{.diameter = 0.2};
  const auto of = [&](double edge) {
    auto body = mesh::with_order(mesh::layered(ball, edge), 2);
    mesh::project_to_sphere(body, ball);
    return estimated(body, 5, {}).estimate(0);
  };
  const double ratio = of(0.05) / of(0.025);
  EXPECT_GT(ratio, 8.0);
  EXPECT_LT(ratio, 32.0);
}

// The estimate knows no difference between a cell in closed form and the same one by quadrature.
TEST(Estimate, IsTheSameByQuadrature) {
  const std::vector<Material> materials{isotropic(70e9, 0.33, 2700.0)};
  auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, 0.05, 1), 2);
  const auto system = assemble(body, materials);
  const auto found = modes(system, {.count = 6}).modes;
  const Eigen::VectorXd straight = frequency_error(body, materials, system, found);
  for (Eigen::Index tet = 0; tet < body.tet_count(); ++tet) {
    for (Eigen::Index a = 4; a < 10; ++a) body.points(body.tets(tet, a), 0) *= 1.0 + 1e-9;
  }
  const Eigen::VectorXd curved = frequency_error(body, materials, system, found);
  for (Eigen::Index i = 6; i < straight.size(); ++i) {
    EXPECT_NEAR(curved(i) / straight(i), 1.0, 1e-5);
  }
}

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

// Shapes of any kind take the memory of modes.
TEST(FrequencyError, TakesTheMemoryThatItForecasts) {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.0075, 3), 2);
  const std::vector<Material> materials{isotropic(70e9, 0.33, 2700.0)};
  const auto system = assemble(body, materials);
  modal::Modes any;
  any.frequency_hz = Eigen::VectorXd::LinSpaced(8, 100.0, 800.0);
  any.shapes = Eigen::MatrixXd::Random(system.stiffness.rows(), 8);
  const auto peak = peak_of([&] {
    const auto estimate = frequency_error(body, materials, system, any);
    return estimate.allFinite() ? frequency_error_bytes(static_cast<double>(body.tet_count()))
                                : 0.0;
  });
  ASSERT_GT(peak.forecast, 1e7);
  EXPECT_LT(peak.used, 1.1 * peak.forecast + 8e6);  // libraries and small vectors
  EXPECT_GT(peak.used, 0.6 * peak.forecast);
  RecordProperty("used_over_forecast", std::to_string(peak.used / peak.forecast));
}

}  // namespace
}  // namespace chladni::fem
