// What a study attaches to its body, on a body that is larger than drawn.
#pragma once

#include "diagnosis/structure.h"
#include "stage/reduction/upper_face.h"
#include "stage/solution.h"

namespace chladni::stage {

/// First-order changes of the attached parts' matrices in the first r modes of the solution, per
/// relative growth of the body along u and v of the chart about the middle of the chart's box. The
/// shapes grow with the body, and the attached parts stay where they are in space: they are placed
/// anew on a body that is slightly larger and on one that is slightly smaller. So rotations, ends
/// of links and footprints, which keep their diameter, are right too. A part at an edge is taken on
/// the side where the body still lies beneath it; one on a face that looks along u or v stays on
/// that face. Empty matrices where nothing is attached. Cost: two search trees of the body's faces,
/// and per part as fem::terms.
/// @param count  r
/// @throws InvalidInput  as fem::terms
[[nodiscard]] diagnosis::BeneathAttached beneath_attached(const Solution& solution,
                                                          Eigen::Index count, const Chart& chart);

}  // namespace chladni::stage
