// From the geometry of a study to tetrahedra.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "mesh/surface.h"
#include "mesh/tet_mesh.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::stage {

/// A body before meshing: cheap to make, and enough to measure it and to find places on it.
struct Outline {
  mesh::TetMesh shell;                   ///< its outer boundary; with linear tetrahedra or those of
                                         ///< the file if no mesher is needed
  std::optional<mesh::Surface> surface;  ///< checked and repaired, for TetGen
  bool file_has_cells = false;           ///< the tetrahedra are those of a file
  double volume = 0.0;                   ///< [m^3]
  std::vector<std::string> notes;        ///< what was found, dropped, assumed or repaired
};

/// Plates, beams, discs, spheres and tables without bores or wafer are meshed in layers. Files of
/// tetrahedra are used as they are. All other bodies are a surface for TetGen.
/// @throws InvalidInput  the dimensions or the file are not plausible, or the surface is not fit
[[nodiscard]] Outline outline_of(const study::Study& study, const Progress& progress = {});

/// The boundary of a disc or sphere, without cells, with the round faces that `body_of` will give
/// it, to find places on it. Nothing for other bodies: their outline is no flatter than their mesh.
/// Cost: linear in the faces.
[[nodiscard]] std::optional<mesh::TetMesh> rounded_outline(const study::Study& study,
                                                           const Outline& outline);

/// Tetrahedra of the study's order (chosen here if the study states none); those of a surface are
/// taken from the cache of `work` where an earlier run has meshed it. Warns where a lower order
/// than the file's takes the curvature from its cells. @throws as mesh::tetrahedralize
[[nodiscard]] mesh::TetMesh body_of(const study::Study& study, const Outline& outline, Work& work);

/// The order of elements for this number of tetrahedra: the study's, or else the file's own, or
/// else 3. It is 2 if there are too many cells for cubic elements; cells that are laid with the
/// default sizes of order 3 stay cubic.
[[nodiscard]] int order_for(const study::Study& study, Eigen::Index tets, int own_order);

/// Number of nodes of `tets` of `order`, by Euler's formula; exact for a body without tunnels.
[[nodiscard]] double node_count(const mesh::TetMesh& linear, int order);

}  // namespace chladni::stage
