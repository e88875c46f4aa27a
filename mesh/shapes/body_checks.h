// Checks the dimensions of a body before it is built.
#pragma once

#include <string>

#include "mesh/bodies.h"

namespace chladni::mesh {

/// @throws InvalidInput  value is not finite or not positive: "plate: thickness is -0.02 m,
///                       expected a positive length"
void require_positive(const std::string& body, const std::string& dimension, double value);

/// @throws InvalidInput  a dimension is not positive or the parts do not fit; names the dimension
void require_fit(const Plate& plate);
void require_fit(const Disc& disc);
void require_fit(const Sphere& sphere);
void require_fit(const WaferTable& table);
void require_fit(const Layering& layering);

/// Number of cells of at most `edge_length` along `length`; at least one.
/// @throws InvalidInput  more than 100 000
[[nodiscard]] int cells_in(double length, double edge_length);

/// Width of one of `count` equal pockets along x or y, after the ribs and rims [m].
[[nodiscard]] double pocket_width(double length, int count, double rib, double rim);

/// Thickness of the outer wall of a table [m].
[[nodiscard]] double rim_of(const WaferTable& table);

/// The boundary faces of a mesh (their corners) as a surface.
[[nodiscard]] Surface boundary_surface(const TetMesh& mesh);

}  // namespace chladni::mesh
