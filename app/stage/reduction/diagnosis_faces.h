// The faces of a body that a diagnosis looks at.
#pragma once

#include <string>
#include <vector>

#include "app/stage/reduction/upper_face.h"
#include "app/study/study.h"

namespace chladni::app {

/// What the study's `[diagnosis] on` comes to.
struct DiagnosedFaces {
  Chart chart;               ///< seen along the way they look
  std::vector<char> chosen;  ///< per boundary face 1 where it is one of them; empty: all
  std::vector<std::string> notes;
};

/// By the rule of all that is about a face (app/stage/faces.h); where nothing is said the top of a wafer
/// counts as well. The chart lies across the way that was
/// asked for, across the mean normal of patches (an axis of the body within 5 degrees of it), and
/// where all faces are meant across the body's shortest side.
/// @throws InvalidInput  as faces_of
[[nodiscard]] DiagnosedFaces diagnosed_faces(const Study& study, const mesh::TetMesh& body);

/// Whether u and v of the chart are those of a study's [[variation]].
[[nodiscard]] bool has_the_axes_of_variations(const Chart& chart, const mesh::TetMesh& body);

}  // namespace chladni::app
