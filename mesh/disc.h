// Round plates of curved cells.
#pragma once

#include "mesh/bodies.h"

namespace chladni::mesh {

/// Moves the nodes of the patches "rim" and "hole" along their radius onto circles that cells of
/// `order` 2 or 3 follow (the polygons of `layered` and `surface` are not round), so that the area
/// within is that of the disc: radii are less than 4e-5 short at 24 edges around. Once with linear
/// cells and once with all nodes, inner edges stay straight.
void project_to_disc(TetMesh& mesh, const Disc& disc, int order);

}  // namespace chladni::mesh
