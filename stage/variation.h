// A body whose material varies as its study says.
#pragma once

#include "mesh/tet_mesh.h"
#include "study/study.h"

namespace chladni::stage {

/// Factors of stiffness and mass, cells×2: means over each cell (exact for the waves). u and v are
/// those of the chart in stage/reduction/upper_face.h.
/// @throws InvalidInput  a factor is 0 or less (names the variation)
[[nodiscard]] Eigen::MatrixX2d varied_factors(const study::Study& study, const mesh::TetMesh& body);

/// Divides the cells into regions of nearly equal factors, with a material each. The step is 0.5 %,
/// or a 256th of the largest change if that is less. Nothing if the study has no variation.
void vary(const study::Study& study, mesh::TetMesh& body, std::vector<fem::Material>& materials);

}  // namespace chladni::stage
