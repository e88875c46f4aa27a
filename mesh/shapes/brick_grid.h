// Bodies made of bricks between straight lines: plates, tables with pockets, and bodies mapped from
// them. One grid gives both the closed surface and the tetrahedra, with the same triangles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Lines at x, y and z divide space into bricks. Each brick is filled or void.
struct BrickGrid {
  std::vector<double> x, y, z;  ///< ascending [m]
  /// For each brick, x fastest: 0 is filled, k > 0 is a void with walls in patch void_patch[k-1].
  std::vector<std::int8_t> kind;
  std::vector<std::string> void_patch;

  /// A grid of filled bricks. @throws InvalidInput  more than 2 million bricks, of which quadratic
  /// tetrahedra have 48 million degrees of freedom
  static BrickGrid block(std::vector<double> x, std::vector<double> y, std::vector<double> z);
  [[nodiscard]] std::size_t brick(int i, int j, int k) const;  ///< index into `kind`
};

/// One stretch of a line of cells: its far end and its number of cells.
struct Stretch {
  double end = 0.0;  ///< [m]
  int cells = 1;
};

/// The lines from `begin` over all stretches.
[[nodiscard]] std::vector<double> lines(double begin, const std::vector<Stretch>& stretches);

/// The lines over stretches that are mirrored about 0. The lines are exactly mirrored and one of
/// them is at 0, so that the tetrahedra are mirrored too. A stretch across 0 gets an even number of
/// cells.
[[nodiscard]] std::vector<double> mirrored_lines(double begin, std::vector<Stretch> stretches);

/// The boundary of the filled bricks: two triangles per side, outward. Sides on the outside of the
/// grid get the patches "top", "bottom", "x_min", "x_max", "y_min", "y_max"; other sides get the
/// patch of the void.
[[nodiscard]] Surface surface(const BrickGrid& grid);

/// Six tetrahedra per filled brick, with the faces and patches of `surface(grid)`. Each brick is
/// cut along its diagonal from the corner with even line numbers to the corner with odd ones
/// (Kuhn's simplices mirrored from brick to brick, Todd's J1). So every grid plane is a mirror
/// plane of the pattern, and x, y, z may be swapped. Cost: linear.
[[nodiscard]] TetMesh tetrahedra(const BrickGrid& grid);

}  // namespace chladni::mesh
