// Restores the volume under the curved parts of a remeshed surface.
#pragma once

#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

/// Remeshing puts new points on curved parts, and the chords between the points lie inside. This
/// function moves the inner points of each patch along their normals, by at most `most` [m, per
/// patch; 0: not at all], so that the patch encloses the same volume as in `before`. Both surfaces
/// have the same patches with the same rims.
void restore_volumes(Surface& after, const Surface& before, const std::vector<double>& most);

}  // namespace chladni::mesh
