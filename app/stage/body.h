// From the geometry of a study to tetrahedra.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/study/study.h"
#include "base/progress.h"
#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::app {

/// A body before it is meshed: cheap to make, and enough to measure it and to find places on it.
struct Outline {
  mesh::TetMesh shell;                   ///< its boundary; with linear or the file's own
                                         ///< tetrahedra where no mesher is needed
  std::optional<mesh::Surface> surface;  ///< checked and repaired: what TetGen is to fill
  double volume = 0.0;                   ///< [m^3]
  std::vector<std::string> notes;        ///< what was found, dropped, guessed or repaired
};

/// Plates, beams, discs, spheres and tables without bores or wafer are laid in layers, files of
/// tetrahedra are taken as they are, all else is a surface for TetGen.
/// @throws InvalidInput  the dimensions or the file cannot be meant, or the surface is not fit
[[nodiscard]] Outline outline_of(const Study& study, const Progress& progress = {});

/// Tetrahedra of the study's order (chosen where it says none).
/// @throws as mesh::tetrahedralize
[[nodiscard]] mesh::TetMesh body_of(const Study& study, const Outline& outline,
                                    const Progress& progress = {});

/// The order of elements for so many tetrahedra: the study's, else the file's own, else 3, or 2
/// where there are so many cells that cubic ones would not fit.
[[nodiscard]] int order_for(const Study& study, Eigen::Index tets, int own_order);

/// Nodes of `tets` of `order`, from Euler's formula; exact for a body without tunnels.
[[nodiscard]] double node_count(const mesh::TetMesh& linear, int order);

}  // namespace chladni::app
