// Curved parts of a surface made to enclose what they did before.
#pragma once

#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// New points lie on the curved parts, the chords between them inside: the points inside of each
/// patch move along their normals, by at most `most` [m, per patch; 0: not at all], until the patch
/// encloses what it did in `before`. Both surfaces have the same patches with the same rims.
void restore_volumes(Surface& after, const Surface& before, const std::vector<double>& most);

}  // namespace chladni::mesh
