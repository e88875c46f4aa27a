// What every element must do. An element added to the table is tested here with no further word.
#include "fem/element.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "base/error.h"
#include "fem/element/element_matrices.h"

namespace chladni::fem {
namespace {

Eigen::Vector4d random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.05, 1.0);
  Eigen::Vector4d l(uniform(random), uniform(random), uniform(random), uniform(random));
  return l / l.sum();
}

// One distorted cell of the element's order, positive volume, straight sides.
mesh::TetMesh cell_of(const Element& element, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.2, 0.2);
  Eigen::Matrix<double, 4, 3> corner;
  corner << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  for (Eigen::Index i = 0; i < 12; ++i) corner.data()[i] += shift(random);
  mesh::TetMesh cell;
  cell.points = element.barycentric * corner;
  cell.tets.resize(1, element.nodes);
  for (int a = 0; a < element.nodes; ++a) cell.tets(0, a) = a;
  cell.region = Eigen::VectorXi::Zero(1);
  cell.region_names = {"body"};
  return cell;
}

const Material kSteel = isotropic(210e9, 0.3, 7850.0);

// The cell's stiffness and mass as full matrices.
struct Full {
  Eigen::MatrixXd stiffness, mass;
};
Full full(const mesh::TetMesh& cell, const Material& material) {
  ElementIntegrator integrator(cell, {material});
  const auto& m = integrator.matrices(0);
  const auto n = cell.tets.cols();
  Full result{Eigen::MatrixXd::Zero(3 * n, 3 * n), Eigen::MatrixXd::Zero(3 * n, 3 * n)};
  Eigen::Index pair = 0;
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        result.mass(3 * a + i, 3 * b + i) = result.mass(3 * b + i, 3 * a + i) = m.mass(pair);
        for (Eigen::Index j = 0; j < 3; ++j) {
          result.stiffness(3 * a + i, 3 * b + j) = m.stiffness(pair, 3 * i + j);
          result.stiffness(3 * b + j, 3 * a + i) = m.stiffness(pair, 3 * i + j);
        }
      }
    }
  }
  return result;
}

class EveryElement : public testing::TestWithParam<const Element*> {
 protected:
  const Element& element = *GetParam();
};

TEST_P(EveryElement, IsOneAtItsNodeAndZeroAtTheOthers) {
  for (Eigen::Index a = 0; a < element.nodes; ++a) {
    const auto at_node = shape(element, element.barycentric.row(a).transpose()).value;
    EXPECT_LT((at_node - Eigen::VectorXd::Unit(element.nodes, a)).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST_P(EveryElement, IsAPartitionOfUnity) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const auto [value, gradient] = shape(element, random_point(random));
    EXPECT_NEAR(value.sum(), 1.0, 1e-13);
    EXPECT_LT(gradient.colwise().sum().cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST_P(EveryElement, HasTheGradientOfItsValues) {
  std::mt19937 random(2);
  constexpr double h = 1e-6;
  for (int i = 0; i < 5; ++i) {
    const auto l = random_point(random);
    const auto exact = shape(element, l).gradient;
    for (Eigen::Index d = 0; d < 3; ++d) {
      const Eigen::Vector4d step = h * (Eigen::Vector4d::Unit(d + 1) - Eigen::Vector4d::Unit(0));
      const Eigen::VectorXd difference =
          (shape(element, l + step).value - shape(element, l - step).value) / (2.0 * h);
      EXPECT_LT((difference - exact.col(d)).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
}

TEST_P(EveryElement, HasTheReferenceIntegralsOfAnExactRule) {
  const auto rule = tet_rule(2 * element.order);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(element.mass_products.size());
  Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(mass.size(), 9);
  for (Eigen::Index q = 0; q < rule.weights.size(); ++q) {
    const auto at = shape(element, rule.points.row(q).transpose());
    Eigen::Index pair = 0;
    for (Eigen::Index a = 0; a < element.nodes; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
        mass(pair) += rule.weights(q) * at.value(a) * at.value(b);
        for (Eigen::Index k = 0; k < 9; ++k) {
          gradients(pair, k) += rule.weights(q) * at.gradient(a, k / 3) * at.gradient(b, k % 3);
        }
      }
    }
  }
  EXPECT_LT((mass - element.mass_products).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((gradients - element.gradient_products).cwiseAbs().maxCoeff(), 1e-11);
}

TEST_P(EveryElement, HasItsMassAndNoMore) {
  const auto cell = cell_of(element, 3);
  const auto [stiffness, mass] = full(cell, kSteel);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd one = Eigen::VectorXd::Zero(mass.rows());
    for (Eigen::Index a = 0; a < element.nodes; ++a) one(3 * a + axis) = 1.0;
    EXPECT_NEAR(one.dot(mass * one) / (7850.0 * mesh::volume(cell)), 1.0, 1e-12);
  }
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(mass).eigenvalues()(0), 0.0);
}

TEST_P(EveryElement, HasSixRigidMotionsAndNoSeventh) {
  const auto [stiffness, mass] = full(cell_of(element, 4), kSteel);
  EXPECT_LT((stiffness - stiffness.transpose()).norm(), 1e-12 * stiffness.norm());
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
  const double largest = values.maxCoeff();
  EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), 1e-12 * largest);
  EXPECT_GT(values(6), 1e-5 * largest);
}

// Energy of u = G x is ½ V ε:C:ε whatever the shape of the cell: the patch test of one cell.
TEST_P(EveryElement, StoresTheEnergyOfAConstantStrain) {
  const auto cell = cell_of(element, 5);
  const auto [stiffness, mass] = full(cell, kSteel);
  Eigen::Matrix3d g;
  g << 1e-3, 2e-4, -3e-4, 4e-4, -5e-4, 6e-4, 7e-4, 1e-4, 9e-4;
  Eigen::VectorXd u(3 * element.nodes);
  for (Eigen::Index a = 0; a < element.nodes; ++a) {
    u.segment<3>(3 * a) = g * cell.points.row(a).transpose();
  }
  Eigen::Matrix<double, 6, 1> strain;
  strain << g(0, 0), g(1, 1), g(2, 2), g(1, 2) + g(2, 1), g(0, 2) + g(2, 0), g(0, 1) + g(1, 0);
  const double expected = mesh::volume(cell) * strain.dot(kSteel.stiffness * strain);
  EXPECT_NEAR(u.dot(stiffness * u) / expected, 1.0, 1e-11);
}

TEST_P(EveryElement, SeesTheSameEnergyInTurnedAxes) {
  auto cell = cell_of(element, 6);
  const Material silicon = cubic(165.7e9, 63.9e9, 79.6e9, 2330.0);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const auto before = full(cell, silicon);
  cell.points = (cell.points * turn.transpose()).eval();
  const auto after = full(cell, turned(silicon, turn));
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * element.nodes, 3 * element.nodes);
  for (Eigen::Index a = 0; a < element.nodes; ++a) all.block<3, 3>(3 * a, 3 * a) = turn;
  EXPECT_LT((all.transpose() * after.stiffness * all - before.stiffness).norm(),
            1e-12 * before.stiffness.norm());
}

// The quadrature for curved cells, on a cell that is bent by next to nothing.
TEST_P(EveryElement, AgreesWithItsOwnQuadrature) {
  if (element.order == 1) return;  // nothing to bend
  auto cell = cell_of(element, 7);
  const auto straight = full(cell, kSteel);
  cell.points(4, 0) += 1e-8;
  const auto curved = full(cell, kSteel);
  EXPECT_LT((straight.stiffness - curved.stiffness).norm(), 1e-6 * straight.stiffness.norm());
  EXPECT_GT((straight.stiffness - curved.stiffness).norm(), 0.0);
  EXPECT_LT((straight.mass - curved.mass).norm(), 1e-6 * straight.mass.norm());
}

INSTANTIATE_TEST_SUITE_P(Fem, EveryElement, testing::ValuesIn(elements().begin(), elements().end()),
                         [](const auto& e) { return std::string(e.param->name); });

TEST(Rules, IntegrateBarycentricMonomialsExactly) {
  // Mean of λ1^i λ2^j: 3! i! j! / (i + j + 3)! on a tetrahedron, 2! i! j! / (i + j + 2)! on a face.
  const auto f = [](int n) { return std::tgamma(n + 1.0); };
  for (int degree = 0; degree <= 9; ++degree) {
    const auto tet = tet_rule(degree);
    const auto triangle = triangle_rule(degree);
    EXPECT_GT(tet.weights.minCoeff(), 0.0);
    for (int i = 0; i <= degree; ++i) {
      const int j = degree - i;
      const Eigen::ArrayXd t = tet.points.col(1).array().pow(i) * tet.points.col(2).array().pow(j);
      EXPECT_NEAR((tet.weights.array() * t).sum(), 6.0 * f(i) * f(j) / f(i + j + 3), 1e-14);
      const Eigen::ArrayXd s =
          triangle.points.col(1).array().pow(i) * triangle.points.col(2).array().pow(j);
      EXPECT_NEAR((triangle.weights.array() * s).sum(), 2.0 * f(i) * f(j) / f(i + j + 2), 1e-14);
    }
  }
}

TEST(Element, OfAnotherOrderIsRefused) { EXPECT_THROW((void)element(7), InvalidInput); }

}  // namespace
}  // namespace chladni::fem
