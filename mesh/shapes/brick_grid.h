// Bodies made of bricks between straight lines: plates, pocketed tables, and what is mapped from
// them. One grid gives both the closed surface and the tetrahedra, with the same triangles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// Lines at x, y and z cut space into bricks; each is filled or void.
struct BrickGrid {
  std::vector<double> x, y, z;  ///< ascending [m]
  /// Per brick, x fastest: 0 filled, k > 0 a void whose walls belong to the patch void_patch[k-1].
  std::vector<std::int8_t> kind;
  std::vector<std::string> void_patch;

  /// All bricks filled. @throws InvalidInput  more than 20 million
  static BrickGrid block(std::vector<double> x, std::vector<double> y, std::vector<double> z);
  [[nodiscard]] std::size_t brick(int i, int j, int k) const;  ///< index into `kind`
};

/// One stretch of a line of cells: its far end and how many cells it is cut into.
struct Stretch {
  double end = 0.0;  ///< [m]
  int cells = 1;
};

/// The lines from `begin` over all stretches.
[[nodiscard]] std::vector<double> lines(double begin, const std::vector<Stretch>& stretches);

/// The same where the stretches lie mirrored about 0: exactly mirrored lines, one of them at 0, so
/// that the tetrahedra are mirrored too (a stretch across 0 gets an even number of cells).
[[nodiscard]] std::vector<double> mirrored_lines(double begin, std::vector<Stretch> stretches);

/// The boundary of the filled bricks: two triangles per side, outward, patches "top", "bottom",
/// "x_min", "x_max", "y_min", "y_max" where nothing is beyond, else those of the voids.
[[nodiscard]] Surface surface(const BrickGrid& grid);

/// Six tetrahedra per filled brick, with the faces and patches of `surface(grid)`. Each brick is
/// cut along its diagonal from the corner of even line numbers to that of odd ones (Kuhn's
/// simplices mirrored from brick to brick, Todd's J1): every grid plane is a mirror plane of the
/// pattern, and x, y, z may be swapped. Cost: linear.
[[nodiscard]] TetMesh tetrahedra(const BrickGrid& grid);

}  // namespace chladni::mesh
