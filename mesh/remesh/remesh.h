// Prepares surfaces for the mesher.
#pragma once

#include "mesh/surface.h"

namespace chladni::mesh {

/// A surface for a mesher that refines planes itself, at `edge_length` [m]. Planes have the fewest
/// triangles; curved parts have isotropic triangles. On lines between parts, points are as far
/// apart as the curvature allows. Sharp edges stay; the volume stays to a thousandth. The surface
/// is returned unchanged where the result would not be sound. Cost: n log n.
[[nodiscard]] Surface with_fewest_planes(const Surface& surface, double edge_length);

/// Whether some part of the surface is curved, and not made of planes wider than `edge_length` [m].
[[nodiscard]] bool is_curved(const Surface& surface, double edge_length);

}  // namespace chladni::mesh
