// A light-weighted table as bricks, for its surface and for its layers.
#pragma once

#include "mesh/bodies.h"
#include "mesh/shapes/brick_grid.h"

namespace chladni::mesh {

/// The grid of a table. Pockets and cut-outs are voids; bores and the wafer are left out. The
/// dimensions must fit (`require_fit`).
[[nodiscard]] BrickGrid grid_of(const WaferTable& table, const Layering& layering);

}  // namespace chladni::mesh
