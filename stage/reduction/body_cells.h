// The body of a study in parts for a diagnosis: columns through it along the chart's normal.
#pragma once

#include "diagnosis/structure.h"
#include "stage/reduction/upper_face.h"
#include "stage/solution.h"

namespace chladni::stage {

/// About 100 cells for a face, 24 for a line. A tetrahedron across a border counts on both sides,
/// by its volume there.
/// @param bends  also compute the parts that go with another power of the thickness
/// Cost: per element some r² times its nodes. On all cores.
[[nodiscard]] diagnosis::BodyCells cells_of(const Model& model, const modal::Modes& modes,
                                            const Chart& chart, const UpperFace& face, bool bends);

/// Twice as many along each side, for a local change of stiffness.
/// @param modes  the `used` modes in use first, then the modes above
[[nodiscard]] diagnosis::FineCells fine_cells_of(const Model& model, const modal::Modes& modes,
                                                 Eigen::Index used, const Chart& chart);

}  // namespace chladni::stage
