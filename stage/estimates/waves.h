// Smooth fields over a body.
#pragma once

#include <utility>

#include "mesh/tet_mesh.h"

namespace chladni::stage {

/// The axes of the body's two longest sides, the longest first; for equal sides the first axis.
[[nodiscard]] std::pair<Eigen::Index, Eigen::Index> longest_sides(const mesh::TetMesh& body);

/// cells×count²: products of cosines of 0 to count − 1 half waves over the two longest sides, at
/// the centres of the cells; column count·a + b has a along the longer one.
[[nodiscard]] Eigen::MatrixXd waves(const mesh::TetMesh& body, int count);

}  // namespace chladni::stage
