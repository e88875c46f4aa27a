// Surfaces made ready for the mesher.
#pragma once

#include "mesh/surface.h"

namespace chladni::mesh {

/// What a mesher needs that renews planes itself, at `edge_length` [m]: planes of the fewest
/// triangles; curved parts of isotropic ones; on the lines between them no points closer than the
/// chords their curvature asks for. Sharp edges stay, the volume to a thousandth. The surface as it
/// is where the result would not be sound. Cost: n log n.
[[nodiscard]] Surface with_fewest_planes(const Surface& surface, double edge_length);

/// Whether part of it is bent rather than made of planes wider than `edge_length` [m].
[[nodiscard]] bool is_curved(const Surface& surface, double edge_length);

}  // namespace chladni::mesh
