// The faces of a body that a diagnosis looks at.
#pragma once

#include <string>
#include <vector>

#include "stage/reduction/upper_face.h"
#include "study/study.h"

namespace chladni::stage {

/// The faces that the study's `[diagnosis] on` selects.
struct DiagnosedFaces {
  Chart chart;               ///< seen in the direction of the faces
  std::vector<char> chosen;  ///< per boundary face 1 if it is selected; empty: all
  std::vector<std::string> notes;
};

/// The common rule for faces (stage/faces.h); by default the top of a wafer is added. The chart
/// is perpendicular to the stated direction, or to the mean normal of the patches (an axis of the
/// body, if that is within 5 degrees). If all faces are meant, it is perpendicular to the body's
/// shortest side.
/// @throws InvalidInput  as faces_of
[[nodiscard]] DiagnosedFaces diagnosed_faces(const study::Study& study, const mesh::TetMesh& body);

/// True if u and v of the chart are those of a study's [[variation]].
[[nodiscard]] bool has_the_axes_of_variations(const Chart& chart, const mesh::TetMesh& body);

}  // namespace chladni::stage
