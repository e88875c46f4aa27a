// Round plates of curved cells.
#pragma once

#include "mesh/bodies.h"

namespace chladni::mesh {

/// Moves the nodes of the patches "rim" and "hole" along their radius onto circles, because the
/// polygons of `layered` and `surface` are not round. The radius is chosen so that cells of `order`
/// 2 or 3 enclose the area of the disc. At 24 edges around it differs by less than 4e-5 (relative)
/// from the disc's radius. Call this once with linear cells and once with all nodes; then inner
/// edges stay straight.
void project_to_disc(TetMesh& mesh, const Disc& disc, int order);

}  // namespace chladni::mesh
