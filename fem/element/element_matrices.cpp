#include "fem/element/element_matrices.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/cpu_clones.h"
#include "base/error.h"

namespace chladni::fem {
namespace {

// Refuses an inverted cell: its stiffness and mass would be negative.
void require_positive(double determinant, const mesh::TetMesh& body, Eigen::Index tet) {
  if (determinant > 0.0) return;
  Eigen::RowVector3d at = Eigen::RowVector3d::Zero();
  for (int i = 0; i < 4; ++i) at += 0.25e3 * body.points.row(body.tets(tet, i));
  throw InvalidInput(
      fmt::format("tetrahedron {} at ({:.4g}, {:.4g}, {:.4g}) mm is inverted or flat: its mapping "
                  "has the determinant {:.3g} m^3, expected more than 0; mesh again, or check the "
                  "node order of the file",
                  tet, at.x(), at.y(), at.z(), determinant));
}

}  // namespace

// The tensor from Voigt's order xx yy zz yz xz xy.
Eigen::Matrix<double, 9, 9> elasticity(const Material& material) {
  constexpr int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  Eigen::Matrix<double, 9, 9> tensor;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          tensor(3 * i + j, 3 * k + l) = material.stiffness(voigt[i][k], voigt[j][l]);
        }
      }
    }
  }
  return tensor;
}

// out = in · factorsᵀ, both pairs×9 and column-major: 81 long vector operations.
CHLADNI_WIDE void combine(const double* in, const double* factors, double* out,
                          Eigen::Index pairs) {
  for (Eigen::Index p = 0; p < 9; ++p) {
    double* to = out + p * pairs;
    for (Eigen::Index r = 0; r < pairs; ++r) to[r] = 0.0;
    for (Eigen::Index q = 0; q < 9; ++q) {
      const double f = factors[p + 9 * q];
      if (f == 0.0) continue;
      const double* from = in + q * pairs;
      for (Eigen::Index r = 0; r < pairs; ++r) to[r] += f * from[r];
    }
  }
}

bool is_straight(const mesh::TetMesh& body, const Element& element, Eigen::Index tet) {
  Eigen::Matrix<double, 4, 3> corner;
  for (int i = 0; i < 4; ++i) corner.row(i) = body.points.row(body.tets(tet, i));
  const double size = (corner.row(1) - corner.row(0)).cwiseAbs().maxCoeff();
  const double far = corner.cwiseAbs().maxCoeff();
  const double allowed = 1e-10 * size + 1e-14 * far;
  for (Eigen::Index a = 4; a < element.nodes; ++a) {
    const Eigen::RowVector3d expected = element.barycentric.row(a) * corner;
    if ((body.points.row(body.tets(tet, a)) - expected).cwiseAbs().maxCoeff() > allowed) {
      return false;
    }
  }
  return true;
}

StraightCell straight_cell(const mesh::TetMesh& body, Eigen::Index tet) {
  const Eigen::RowVector3d origin = body.points.row(body.tets(tet, 0));
  Eigen::Matrix3d edges;  // ∂x/∂ξ, a column per edge
  for (int i = 0; i < 3; ++i) {
    edges.col(i) = (body.points.row(body.tets(tet, i + 1)) - origin).transpose();
  }
  return {edges.determinant() / 6.0, edges.inverse()};
}

// ∫ ∂_k N_a ∂_l N_b = V Σ_mn ∂_k ξ_m ∂_l ξ_n G_mn.
Eigen::Matrix<double, 9, 9> stiffness_factors(const StraightCell& cell,
                                              const Eigen::Matrix<double, 9, 9>& elasticity) {
  Eigen::Matrix<double, 9, 9> to_physical;
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      for (int m = 0; m < 3; ++m) {
        for (int n = 0; n < 3; ++n) {
          to_physical(3 * k + l, 3 * m + n) = cell.gradient(m, k) * cell.gradient(n, l);
        }
      }
    }
  }
  return cell.volume * elasticity * to_physical;
}

ElementIntegrator::ElementIntegrator(const mesh::TetMesh& body,
                                     const std::vector<Material>& materials)
    : body_(body), element_(element(body.order())), may_be_curved_(body.order() > 1) {
  for (const auto& material : materials) {
    elasticity_.push_back(elasticity(material));
    density_.push_back(material.density);
  }
  const auto pairs = element_.mass_products.size();
  result_.stiffness.resize(pairs, 9);
  result_.mass.resize(pairs);
  if (!may_be_curved_) return;
  gradients_.resize(pairs, 9);
  const auto rule = tet_rule(2 * element_.order + 2);
  weights_ = rule.weights;
  for (const auto point : rule.points.rowwise()) {
    at_points_.push_back(shape(element_, point.transpose()));
  }
}

const ElementMatrices& ElementIntegrator::matrices(Eigen::Index tet) {
  if (!may_be_curved_ || is_straight(body_, element_, tet)) {
    integrate_straight(tet);
  } else {
    integrate_curved(tet);
  }
  return result_;
}

void ElementIntegrator::integrate_straight(Eigen::Index tet) {
  const auto cell = straight_cell(body_, tet);
  require_positive(6.0 * cell.volume, body_, tet);
  const auto region = static_cast<std::size_t>(body_.region(tet));
  const Tensor factors = stiffness_factors(cell, elasticity_[region]);
  combine(element_.gradient_products.data(), factors.data(), result_.stiffness.data(),
          element_.gradient_products.rows());
  result_.mass = (density_[region] * cell.volume) * element_.mass_products;
}

void ElementIntegrator::integrate_curved(Eigen::Index tet) {
  Eigen::Matrix<double, Eigen::Dynamic, 3> nodes(element_.nodes, 3);
  for (Eigen::Index a = 0; a < element_.nodes; ++a)
    nodes.row(a) = body_.points.row(body_.tets(tet, a));
  const auto region = static_cast<std::size_t>(body_.region(tet));
  gradients_.setZero();
  result_.mass.setZero();
  for (std::size_t q = 0; q < at_points_.size(); ++q) {
    const auto& at = at_points_[q];
    const Eigen::Matrix3d jacobian = nodes.transpose() * at.gradient;
    const double determinant = jacobian.determinant();
    require_positive(determinant, body_, tet);
    const double w = weights_(static_cast<Eigen::Index>(q)) * determinant / 6.0;
    const Eigen::Matrix<double, Eigen::Dynamic, 3> slope = at.gradient * jacobian.inverse();
    Eigen::Index pair = 0;
    for (Eigen::Index a = 0; a < element_.nodes; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
        result_.mass(pair) += density_[region] * w * at.value(a) * at.value(b);
        for (int k = 0; k < 3; ++k) {
          for (int l = 0; l < 3; ++l) {
            gradients_(pair, 3 * k + l) += w * slope(a, k) * slope(b, l);
          }
        }
      }
    }
  }
  combine(gradients_.data(), elasticity_[region].data(), result_.stiffness.data(),
          gradients_.rows());
}

}  // namespace chladni::fem
