// Points that a caller gives, as sites of a body.
#pragma once

#include <optional>
#include <vector>

#include "base/arrays.h"
#include "mesh/site.h"
#include "mesh/tet_mesh.h"
#include "study/place.h"

namespace chladni::stage {

/// How far a channel, a point or an attachment may be off the body [m]: 1 mm, but no more than a
/// hundredth of the body's longest side.
[[nodiscard]] double reach_of(const mesh::TetMesh& body);

/// The sites nearest to `points`, n×3 [m].
/// @param reach          `reach_of` the body
/// @throws InvalidInput  a point is farther off the surface: names its row, its place and the
///                       nearest one
[[nodiscard]] std::vector<mesh::Site> sites_near(const mesh::SiteFinder& finder,
                                                 const Points& points, double reach);

/// The place of a study on a body: seen from above, or the nearest one. Where nothing is below a
/// place that is seen from above, the point nearest to the vertical line through it. Its `distance`
/// is from the place (seen from above: from the line); how far it may be is the caller's to say.
[[nodiscard]] mesh::Site site_at(const mesh::SiteFinder& finder, const study::Place& place);

/// The direction at each site, n×3, unit: one for all, one for each, or (none) the outward normals.
/// @throws InvalidInput  another number of rows, or a direction of length 0
[[nodiscard]] Points directions_at(const std::vector<mesh::Site>& sites,
                                   const std::optional<Points>& directions);

}  // namespace chladni::stage
