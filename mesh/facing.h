// The part of a boundary that faces a direction.
#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// A face faces a direction where its outward normal deviates from it by at most this angle.
inline constexpr double kFacingDegrees = 30.0;

/// The result of `facing`.
struct Facing {
  std::vector<char> face;   ///< per boundary face: 1 where it is chosen
  double area = 0.0;        ///< [m²]: of the chosen faces, projected along the direction
  double silhouette = 0.0;  ///< [m²]: projected area of all visible faces of the body
  int parts = 0;            ///< connected parts that are chosen
  int small_parts = 0;      ///< parts left out: each less than 1 % of the largest part's area

  [[nodiscard]] bool empty() const { return parts == 0; }
};

/// Chooses the faces whose normals lie within kFacingDegrees of `direction` and that an observer
/// far away in this direction sees. Faces below other parts of the body (the floor of a closed box)
/// are not chosen. Small parts, such as the floors of screw holes, are left out. Curved faces are
/// judged by their corners.
/// @param body  only the boundary is used, so a mesh without tetrahedra is enough
/// @param direction  unit
/// @throws InvalidInput  the direction is no unit vector, or the body has no boundary faces
/// Cost: n log n in the faces.
[[nodiscard]] Facing facing(const TetMesh& body, const Eigen::Vector3d& direction);

}  // namespace chladni::mesh
