// A point well inside of a body.
#pragma once

#include "mesh/surface.h"

namespace chladni::mesh {

/// Halfway between the middle of a large triangle and the wall across from it [m].
/// @throws InvalidInput  the surface is not closed and oriented outward
[[nodiscard]] Eigen::Vector3d inside_point(const Surface& surface);

}  // namespace chladni::mesh
