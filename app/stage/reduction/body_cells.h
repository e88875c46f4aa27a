// The body of a study in parts, as a diagnosis sees them: columns through it along the chart's
// normal.
#pragma once

#include "app/stage/reduction/upper_face.h"
#include "app/stage/solution.h"
#include "diagnosis/structure.h"

namespace chladni::app {

/// About 100 cells of a face, 24 of a line. Tetrahedra that lie across a border count to both sides
/// by their volume there.
/// @param bends  also what goes otherwise with the thickness
/// Cost: per element some r² times its nodes. On all cores.
[[nodiscard]] diagnosis::BodyCells cells_of(const Model& model, const modal::Modes& modes,
                                            const Chart& chart, const UpperFace& face, bool bends);

/// Twice as many along each side, for what is soft or stiff in one place.
/// @param modes  those in use first, `used` of them, then the modes above
[[nodiscard]] diagnosis::FineCells fine_cells_of(const Model& model, const modal::Modes& modes,
                                                 Eigen::Index used, const Chart& chart);

}  // namespace chladni::app
