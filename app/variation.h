// A body whose material varies as its study says.
#pragma once

#include "app/study.h"
#include "mesh/tet_mesh.h"

namespace chladni::app {

/// Factors of stiffness and mass, cells×2, at the centres of the cells; u and v are the chart of
/// app/upper_face.h.
/// @throws InvalidInput  a factor is 0 or less (names the variation)
[[nodiscard]] Eigen::MatrixX2d varied_factors(const Study& study, const mesh::TetMesh& body);

/// Puts the cells into regions of like factors, 0.5 % apart in stiffness, with a material each.
/// Nothing where the study says no variation.
void vary(const Study& study, mesh::TetMesh& body, std::vector<fem::Material>& materials);

}  // namespace chladni::app
