// A body whose material varies as its study says.
#pragma once

#include "app/study/study.h"
#include "mesh/tet_mesh.h"

namespace chladni::app {

/// Factors of stiffness and mass, cells×2, in the mean over each cell (exact for the waves); u and
/// v are the chart of app/stage/reduction/upper_face.h.
/// @throws InvalidInput  a factor is 0 or less (names the variation)
[[nodiscard]] Eigen::MatrixX2d varied_factors(const Study& study, const mesh::TetMesh& body);

/// Puts the cells into regions of like factors, with a material each: 0.5 % apart, and a 256th of
/// the largest change where that is less. Nothing where the study says no variation.
void vary(const Study& study, mesh::TetMesh& body, std::vector<fem::Material>& materials);

}  // namespace chladni::app
