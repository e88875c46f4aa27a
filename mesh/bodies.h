// Bodies given by their dimensions. Origin at the centre of the top face, x along the length, y
// along the width, z up, the body below z = 0. All lengths in m.
#pragma once

#include <optional>
#include <vector>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

struct Plate {  // also the beam: a plate that is long
  double length = 0.0, width = 0.0, thickness = 0.0;
};

/// A circular plate, such as a deformable mirror; its rim is a regular polygon of the same area.
struct Disc {
  double diameter = 0.0, thickness = 0.0;
  double hole_diameter = 0.0;  ///< 0: none
};

struct Bore {  // a round hole along z
  Eigen::Vector2d centre;
  double diameter = 0.0;
  double depth = 0.0;  ///< from the bottom; 0: through
};

/// A light-weighted table: a face sheet on top, pockets cut from below between ribs and a rim.
struct WaferTable {
  double length = 0.0, width = 0.0, height = 0.0;
  double face_sheet = 0.0;            ///< thickness left above the pockets
  int pockets_x = 0, pockets_y = 0;   ///< 0 by 0: a plain block
  double rib = 0.0;                   ///< thickness of the ribs between two pockets
  double rim = 0.0;                   ///< thickness of the outer wall; 0: that of a rib
  double edge_cutout_length = 0.0;    ///< halfway along each edge, for the in-plane actuators: along
  double edge_cutout_depth = 0.0;     ///< the edge, and into the body; over the whole height
  double corner_cutout = 0.0;         ///< square, at each corner, for the gravity compensators
  std::vector<Bore> bores;
  double wafer_diameter = 0.0;        ///< a dummy wafer bonded on top: region "wafer"
  double wafer_thickness = 0.0;
};

/// Closed surfaces with the patches "top", "bottom", "x_min", "x_max", "y_min", "y_max" (a disc:
/// "rim"), "pockets", "cutouts", "bores" where there are such.
/// @throws InvalidInput  a dimension is not positive or not finite, or the parts do not fit (ribs
///                       wider than their pitch, a bore outside); names the dimension
[[nodiscard]] Surface surface(const Plate& plate);
[[nodiscard]] Surface surface(const Disc& disc, double edge_length);
[[nodiscard]] Surface surface(const WaferTable& table, double edge_length);

/// Tetrahedra laid in layers, without a mesher: `edge_length` in the plane, `layers` through the
/// thickness (of the face sheet for a table). The pattern has the body's own symmetry (both mirror
/// planes, and the diagonals of a square), so that repeated modes stay repeated. Linear cells.
/// @throws InvalidInput  as above, or the table has bores or a wafer (only TetGen can cut those)
[[nodiscard]] TetMesh layered(const Plate& plate, double edge_length, int layers);
[[nodiscard]] TetMesh layered(const Disc& disc, double edge_length, int layers);
[[nodiscard]] TetMesh layered(const WaferTable& table, double edge_length, int layers);

}  // namespace chladni::mesh
