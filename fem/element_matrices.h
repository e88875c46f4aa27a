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

/// Cells of one mesh, one after the other, with the work space kept. Straight-sided cells in closed
/// form, curved ones (a node off the place that its corners give it) by quadrature.
class ElementIntegrator {
 public:
  ElementIntegrator(const mesh::TetMesh& body, const std::vector<Material>& materials);
  /// The same cells with another element on them than the mesh's own (order 4 on a mesh of order
  /// 3): straight sides only.
  ElementIntegrator(const mesh::TetMesh& body, const std::vector<Material>& materials,
                    const Element& element);

  /// Valid until the next call. Cost: 81 multiplications per pair of nodes.
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
