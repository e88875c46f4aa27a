// What a study attaches to its body, on a body that is larger than drawn.
#pragma once

#include "diagnosis/structure.h"
#include "stage/reduction/upper_face.h"
#include "stage/solution.h"

namespace chladni::stage {

/// The attached parts as linear forms on the first r modes of the solution, on the body as drawn
/// and on bodies that are up to some 20 % larger or smaller along u and v of the chart, about the
/// middle of the chart's box. The shapes grow with the body, and the attached parts stay where they
/// are in space: they are placed anew on each of these bodies. So rotations, ends of links and
/// footprints, which keep their diameter, are right too. Where a body no longer lies beneath a
/// part, as a smaller one at an edge, its rows go on as they came from the other side. A part on a
/// face that looks along u or v stays on that face. No rows where nothing is attached. Cost: twelve
/// search trees of the body's faces, and per part eleven times fem::terms.
/// @param count  r
/// @throws InvalidInput  as fem::terms
[[nodiscard]] diagnosis::BeneathAttached beneath_attached(const Solution& solution,
                                                          Eigen::Index count, const Chart& chart);

}  // namespace chladni::stage
