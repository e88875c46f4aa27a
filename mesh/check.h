// Is a surface fit to be meshed, and what can safely be mended?
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "mesh/surface.h"

namespace chladni::mesh {

/// One thing found, in words and in place.
struct Finding {
  enum class Severity { note, repaired, refused };
  Severity severity = Severity::note;
  std::string what;    ///< "surface is open: 3 holes, the largest near (12.0, 40.5, 0.0) mm, 14 edges"
  std::string remedy;  ///< "close it in CAD, or set repair = \"fill\""; empty for notes
};

struct SurfaceReport {
  std::vector<Finding> findings;  ///< at most the first 20 places of each kind
  double volume = 0.0;            ///< [m^3], after repair
  double area = 0.0;              ///< [m^2]
  int bodies = 0;                 ///< connected components that are outer boundaries
  [[nodiscard]] bool fit() const;  ///< no finding is refused
  [[nodiscard]] std::string text() const;
};

struct RepairOptions {
  bool fill_holes = false;            ///< closes holes of at most `largest_hole_edges` edges
  int largest_hole_edges = 200;
};

/// Repairs in place what is safe (merges duplicate vertices, removes duplicate and degenerate
/// triangles and unused points, orients a closed surface outward, fills small holes only on
/// request), says each of it, and finds what is not: open, non-manifold, self-intersecting (the
/// first ten pairs with their places), zero volume, points that are not finite, several bodies that
/// do not touch. Patches follow their triangles. Cost: n log n.
[[nodiscard]] SurfaceReport check_and_repair(Surface& surface, const RepairOptions& options = {});

/// Isotropic triangles of `edge_length` [m] that keep edges sharper than `sharp_degrees` and the
/// borders between patches; patches are kept.
/// @throws InvalidInput  edge_length is not positive
[[nodiscard]] Surface remesh(const Surface& surface, double edge_length,
                             double sharp_degrees = 30.0);

/// Booleans of closed bodies by corefinement; each triangle keeps the patch of the body it came
/// from. @throws InvalidInput  a body is not closed or intersects itself
[[nodiscard]] Surface united(const Surface& a, const Surface& b);
[[nodiscard]] Surface difference(const Surface& a, const Surface& b);
/// a and b touching along faces, as two regions: the common faces are there once and belong to the
/// patch "interface_<region of b>"; the regions are named `name_a`, `name_b`.
[[nodiscard]] Surface bonded(const Surface& a, const Surface& b, const std::string& name_a,
                             const std::string& name_b);

}  // namespace chladni::mesh
