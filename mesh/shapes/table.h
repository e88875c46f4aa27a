// A light-weighted table as bricks, for its surface and for its layers.
#pragma once

#include "mesh/bodies.h"
#include "mesh/shapes/brick_grid.h"

namespace chladni::mesh {

/// Pockets and cut-outs are voids of the grid; bores and the wafer are left out. The table fits
/// (`require_fit`).
[[nodiscard]] BrickGrid grid_of(const WaferTable& table, const Layering& layering);

}  // namespace chladni::mesh
