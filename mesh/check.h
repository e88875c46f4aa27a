// Checks whether a surface can be meshed, and repairs what is safe to repair.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "mesh/surface.h"

namespace chladni::mesh {

/// One finding, with its place in words.
struct Finding {
  enum class Severity { note, repaired, refused };
  Severity severity = Severity::note;
  std::string what;    ///< "the surface is open: 3 holes, the largest near (12, 40.5, 0) mm, ..."
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

/// Makes the safe repairs in place and reports each one: merges duplicate vertices, removes
/// duplicate and degenerate triangles and unused points, orients a closed surface outward, and
/// fills small holes on request only. Refuses what cannot be repaired: an open, non-manifold or
/// self-intersecting surface (names the first ten pairs with their places), zero volume, points
/// that are not finite, several bodies that do not touch. Patches follow their triangles. Cost:
/// n log n.
[[nodiscard]] SurfaceReport check_and_repair(Surface& surface, const RepairOptions& options = {});

/// Isotropic triangles of `edge_length` [m] that keep edges sharper than `sharp_degrees` and the
/// borders between patches; patches are kept.
/// @throws InvalidInput  edge_length is not positive, or more than 2 million triangles are needed
[[nodiscard]] Surface remesh(const Surface& surface, double edge_length,
                             double sharp_degrees = 30.0);

/// Booleans of closed bodies by corefinement. Each triangle keeps the patch of its original body.
/// @throws InvalidInput  a body is not closed or intersects itself
[[nodiscard]] Surface united(const Surface& a, const Surface& b);
[[nodiscard]] Surface difference(const Surface& a, const Surface& b);
/// Joins a and b, which touch along faces, as two regions. The common faces occur once and belong
/// to the patch "interface_<region of b>". The regions are named `name_a`, `name_b`.
[[nodiscard]] Surface bonded(const Surface& a, const Surface& b, const std::string& name_a,
                             const std::string& name_b);

}  // namespace chladni::mesh
