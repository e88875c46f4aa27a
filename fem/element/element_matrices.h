// Stiffness and mass of one tetrahedron.
#pragma once

#include <array>
#include <vector>

#include "fem/element.h"
#include "fem/material.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {

/// Per pair of nodes (a, b), a >= b, at row a(a+1)/2 + b.
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

/// C_ikjl at row 3i + j, column 3k + l, as K_(a,i)(b,j) = ∫ ∂_k N_a C_ikjl ∂_l N_b asks for [Pa].
[[nodiscard]] Eigen::Matrix<double, 9, 9> elasticity(const Material& material);

/// F with which reference products G (pairs×9, as Element::gradient_products) become stiffness:
/// G Fᵀ, column 3i + j.
[[nodiscard]] Eigen::Matrix<double, 9, 9> stiffness_factors(
    const StraightCell& cell, const Eigen::Matrix<double, 9, 9>& elasticity);

/// out = in Fᵀ for pairs×9 arrays, column-major.
void combine(const double* in, const double* factors, double* out, Eigen::Index pairs);

/// Cells of one mesh, one after the other, with the work space kept. Straight-sided cells in closed
/// form, curved ones (a node off the place that its corners give it) by quadrature.
class ElementIntegrator {
 public:
  ElementIntegrator(const mesh::TetMesh& body, const std::vector<Material>& materials);

  /// Valid until the next call. Cost: 81 multiplications per pair of nodes.
  /// @throws InvalidInput  the cell is inverted or flat where it is integrated
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
