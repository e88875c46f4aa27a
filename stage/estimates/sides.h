// The sides of a body, however it is turned.
#pragma once

#include "mesh/tet_mesh.h"

namespace chladni::stage {

/// Length, width and height of the box around the boundary [m]: of the box along x, y, z, or of the
/// smallest that turns from the principal axes of the boundary's area find where that one is
/// smaller. A body that is turned in its file has the sides of the body, to a few per cent. Cost:
/// at most 405 passes over the points.
[[nodiscard]] Eigen::Vector3d sides_of(const mesh::TetMesh& shell);

}  // namespace chladni::stage
