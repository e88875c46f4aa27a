// Modal stiffness and mass of a body whose moduli and densities are multiplied by fields.
#pragma once

#include <vector>

#include "fem/material.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {

/// Φᵀ K_f Φ and Φᵀ M_f Φ for each field f. K_f and M_f are the stiffness and mass of a body whose
/// moduli and densities are multiplied by the field. A field of ones gives diag λ and the identity.
struct FieldMatrices {
  std::vector<Eigen::MatrixXd> stiffness;  ///< one m×m per column of the first fields [s^-2]
  std::vector<Eigen::MatrixXd> mass;       ///< one m×m per column of the second
};

/// @param shapes            3·nodes×m [kg^-1/2]
/// @param stiffness_fields  cells×F; @param mass_fields  cells×G
/// Cost: per cell, m products with its stiffness matrix, and m² per field; 34 (F + G) m² doubles.
/// Runs on all cores, with the same bits for any number of threads.
/// @throws InvalidInput  an array does not fit the mesh
[[nodiscard]] FieldMatrices field_matrices(const mesh::TetMesh& body,
                                           const std::vector<Material>& materials,
                                           const Eigen::MatrixXd& shapes,
                                           const Eigen::MatrixXd& stiffness_fields,
                                           const Eigen::MatrixXd& mass_fields);

}  // namespace chladni::fem
