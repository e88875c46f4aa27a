// Stiffness and mass of one tetrahedron.
#pragma once

#include <array>
#include <vector>

#include "fem/element.h"
#include "fem/material.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {

/// Stiffness and mass of one cell. The pair of nodes (a, b), a >= b, is at row a(a+1)/2 + b.
struct ElementMatrices {
  Eigen::Matrix<double, Eigen::Dynamic, 9> stiffness;  ///< column 3i + j: K_(a,i)(b,j) [N/m]
  Eigen::VectorXd mass;                                ///< M_ab, equal for the three axes [kg]
};

/// Whether every node of cell `tet` lies where its corners and `element`'s lattice put it.
[[nodiscard]] bool is_straight(const mesh::TetMesh& body, const Element& element, Eigen::Index tet);

/// A tetrahedron with straight sides, from its corners.
struct StraightCell {
  double volume = 0.0;       ///< [m^3]
  Eigen::Matrix3d gradient;  ///< row m: ∇ξ_m [1/m]
};
[[nodiscard]] StraightCell straight_cell(const mesh::TetMesh& body, Eigen::Index tet);

/// C_ikjl at row 3i + j, column 3k + l, as needed in K_(a,i)(b,j) = ∫ ∂_k N_a C_ikjl ∂_l N_b [Pa].
[[nodiscard]] Eigen::Matrix<double, 9, 9> elasticity(const Material& material);

/// The factors F that turn reference products G (pairs×9, as Element::gradient_products) into the
/// stiffness G Fᵀ, column 3i + j.
[[nodiscard]] Eigen::Matrix<double, 9, 9> stiffness_factors(
    const StraightCell& cell, const Eigen::Matrix<double, 9, 9>& elasticity);

/// out = in Fᵀ for pairs×9 arrays, column-major.
void combine(const double* in, const double* factors, double* out, Eigen::Index pairs);

/// Integrates the cells of one mesh, one after the other, and keeps the work space. Straight-sided
/// cells are integrated in closed form. Curved cells (is_straight is false) are integrated by
/// quadrature.
class ElementIntegrator {
 public:
  ElementIntegrator(const mesh::TetMesh& body, const std::vector<Material>& materials);

  /// The matrices of cell `tet`, valid until the next call. Cost: 81 multiplications per pair of
  /// nodes on a straight-sided cell.
  /// @throws InvalidInput  the cell is inverted or flat at an integration point
  [[nodiscard]] const ElementMatrices& matrices(Eigen::Index tet);

 private:
  using Tensor = Eigen::Matrix<double, 9, 9>;
  void integrate_straight(Eigen::Index tet);
  void integrate_curved(Eigen::Index tet);

  const mesh::TetMesh& body_;
  const Element& element_;
  std::vector<Tensor> elasticity_;  // per region: row 3i + j, column 3k + l: C_ikjl
  std::vector<double> density_;
  std::vector<ShapeValues> at_points_;  // of the rule for curved cells
  Eigen::VectorXd weights_;
  bool may_be_curved_;
  ElementMatrices result_;
  Eigen::Matrix<double, Eigen::Dynamic, 9> gradients_;  // curved: ∫ ∂_k N_a ∂_l N_b
};

}  // namespace chladni::fem
