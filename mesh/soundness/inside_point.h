// A point well inside a body.
#pragma once

#include "mesh/surface.h"

namespace chladni::mesh {

/// The point halfway between the middle of a large triangle and the wall opposite to it [m].
/// @throws InvalidInput  the surface is not closed and oriented outward
[[nodiscard]] Eigen::Vector3d inside_point(const Surface& surface);

}  // namespace chladni::mesh
