// Bodies given by their dimensions. The origin is the centre of the top face; x is along the
// length, y along the width, z up. The body lies below z = 0. All lengths are in m.
#pragma once

#include <optional>
#include <vector>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

struct Plate {  // a beam is a long plate
  double length = 0.0, width = 0.0, thickness = 0.0;
};

/// A circular plate, such as a deformable mirror; its rim is a regular polygon of the same area.
struct Disc {
  double diameter = 0.0, thickness = 0.0;
  double hole_diameter = 0.0;  ///< 0: none
};

/// A convex plate with four corners (x, y) [m], counter-clockwise seen from above.
struct Quadrilateral {
  Eigen::Matrix<double, 4, 2> corners;
  double thickness = 0.0;
};

/// A sphere centred at the origin, for tests against Lamb's exact modes.
struct Sphere {
  double diameter = 0.0;
  double hole_diameter = 0.0;  ///< concentric; 0: solid
};

struct Bore {  // a round hole along z
  Eigen::Vector2d centre;
  double diameter = 0.0;
  double depth = 0.0;  ///< from the bottom; 0: through
};

/// A light-weighted table: a face sheet on top, pockets cut from below between ribs and a rim.
struct WaferTable {
  double length = 0.0, width = 0.0, height = 0.0;
  double face_sheet = 0.0;           ///< thickness of the sheet above the pockets
  int pockets_x = 0, pockets_y = 0;  ///< 0 by 0: a plain block
  double rib = 0.0;                  ///< thickness of the ribs between two pockets
  double rim = 0.0;                  ///< thickness of the outer wall; 0: that of a rib
  double edge_cutout_length = 0.0;   ///< cut-out in the middle of each edge, along the edge
  double edge_cutout_depth = 0.0;    ///< its depth into the body (for the in-plane actuators)
  double corner_cutout = 0.0;        ///< side of the square cut-out at each corner (for the
                                     ///< gravity compensators); all cut-outs go through
  std::vector<Bore> bores = {};
  double wafer_diameter = 0.0;  ///< dummy wafer bonded on top: region "wafer"
  double wafer_thickness = 0.0;
};

/// How finely a body is divided into cells.
struct Layering {
  double edge_length = 0.0;  ///< in the plane [m]
  int layers = 1;            ///< through the thickness (of the face sheet for a table)
  int across_ribs = 1;       ///< cells through the thickness of a rib
  /// Width of a row of cells along the outline of a plate or along the walls of every pocket of a
  /// table [m]; 0: none. Discs do not use it. Twist bends the edges of a thin plate within a strip
  /// about as wide as the plate's thickness.
  double edge_strip = 0.0;
};

/// The layering that brings the first 20 frequencies within 1 % of the converged ones. This holds
/// for order 3 and for plates of order 2; for tables of order 2 it holds except for the twist of
/// open ribs. Order 1 is for comparison only.
/// @throws InvalidInput  order is not 1, 2 or 3, or a dimension does not fit
[[nodiscard]] Layering default_layering(const Plate& plate, int order);
[[nodiscard]] Layering default_layering(const Disc& disc, int order);
[[nodiscard]] Layering default_layering(const WaferTable& table, int order);

/// Closed surfaces with the patches "top", "bottom", "x_min", "x_max", "y_min", "y_max" (a disc:
/// "rim" and "hole"), and "pockets", "cutouts", "bores" where the body has them. A wafer on top is
/// a separate region (regions "body", "wafer") with the patches "wafer_top" and "wafer_rim".
/// Between a pocket and a cut-out there is a wall as thick as the rim.
/// @throws InvalidInput  a dimension is not positive or not finite, or the parts do not fit (ribs
///                       wider than their pitch, a bore outside); names the dimension
[[nodiscard]] Surface surface(const Plate& plate);
[[nodiscard]] Surface surface(const Disc& disc, double edge_length);
[[nodiscard]] Surface surface(const WaferTable& table, double edge_length);
[[nodiscard]] Surface surface(const Sphere& sphere, double edge_length);  // "outer", "inner"

/// Tetrahedra in layers, without a mesher. The pattern has the body's own symmetry (both mirror
/// planes, and the diagonals of a square), so that repeated modes stay repeated. The pattern of a
/// disc repeats every 30 degrees. Cells are linear; corners are numbered from layer to layer.
/// @throws InvalidInput  as above, or the table has bores or a wafer (only TetGen can mesh those),
///                       or edge_length or a count is not positive
[[nodiscard]] TetMesh layered(const Plate& plate, const Layering& layering);
[[nodiscard]] TetMesh layered(const Disc& disc, const Layering& layering);
[[nodiscard]] TetMesh layered(const WaferTable& table, const Layering& layering);
[[nodiscard]] TetMesh layered(const Quadrilateral& plate, const Layering& layering);
/// A cube of bricks mapped to a ball; with a hole the inner cube is left out. The corners of the
/// patches "outer" and "inner" lie on the spheres. The pattern has the symmetry of a cube.
[[nodiscard]] TetMesh layered(const Sphere& sphere, double edge_length);

template <typename Body>
[[nodiscard]] TetMesh layered(const Body& body, double edge_length, int layers) {
  return layered(body, Layering{.edge_length = edge_length, .layers = layers});
}

/// Moves the boundary nodes of a mesh of `layered(sphere, ...)`, of any order, onto the spheres.
/// The cells at the boundary become curved.
void project_to_sphere(TetMesh& mesh, const Sphere& sphere);

}  // namespace chladni::mesh
