// The messages on the mesher's pipe: packed and little-endian. The reader checks every count
// against the bytes that are there before it allocates memory. This file uses the standard library
// only.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace chladni::mesh::wire {

/// A place inside one part of the body, and the largest volume of the cells there.
struct Seed {
  double x = 0.0, y = 0.0, z = 0.0;  ///< [m]
  double largest_volume = 0.0;       ///< [m^3], > 0
};

struct Request {
  double largest_radius_edge = 0.0;
  double smallest_dihedral_degrees = 0.0;
  double largest_volume = 0.0;          ///< of all cells [m^3]
  std::vector<double> points;           ///< 3 per point [m]
  std::vector<std::int32_t> triangles;  ///< 3 per triangle, from 0
  std::vector<std::int32_t> markers;    ///< 1 per triangle, > 0
  std::vector<Seed> seeds;              ///< seed i gives its part the attribute i + 1
  std::int32_t surface_stays = 0;       ///< 1: no new points on the surface
};

struct Reply {
  std::vector<double> points;              ///< 3 per point [m]
  std::vector<std::int32_t> tets;          ///< 4 per cell, from 0, either orientation
  std::vector<std::int32_t> parts;         ///< 1 per cell: its seed's attribute or another number
  std::vector<std::int32_t> faces;         ///< 3 per face of the input's surface
  std::vector<std::int32_t> face_markers;  ///< 1 per face
};

[[nodiscard]] std::string bytes_of(const Request& request);
[[nodiscard]] std::string bytes_of(const Reply& reply);

/// @throws std::runtime_error  another magic number or version, a count that the bytes do not hold,
///                             counts that do not fit each other, an index out of range, a number
///                             that is not finite, bytes left over
[[nodiscard]] Request request_from(std::string_view bytes);
[[nodiscard]] Reply reply_from(std::string_view bytes);

}  // namespace chladni::mesh::wire
