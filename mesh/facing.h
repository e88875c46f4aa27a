// The part of a boundary that looks one way.
#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// A face looks along a direction where its outward normal is at most so far away from it.
inline constexpr double kFacingDegrees = 30.0;

/// What `facing` found.
struct Facing {
  std::vector<char> face;   ///< per boundary face: 1 where it is one of them
  double area = 0.0;        ///< [m²]: theirs, seen along the direction
  double silhouette = 0.0;  ///< [m²]: all that is seen of the body from there
  int parts = 0;            ///< connected ones that were taken
  int small_parts = 0;      ///< left out: less than a hundredth of the largest one's area each

  [[nodiscard]] bool empty() const { return parts == 0; }
};

/// The faces that look along `direction` within kFacingDegrees and that a far observer sees who
/// looks against it: what lies under something else is not of them (the floor of a box). Small
/// parts, such as the floors of screw holes, are left out. The corners of curved faces count.
/// @param body  its tetrahedra are not looked at: a shell will do
/// @param direction  unit
/// @throws InvalidInput  the direction is no unit vector, or the body has no boundary faces
/// Cost: n log n in the faces.
[[nodiscard]] Facing facing(const TetMesh& body, const Eigen::Vector3d& direction);

}  // namespace chladni::mesh
