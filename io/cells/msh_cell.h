// The element types of Gmsh.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace chladni::io {

struct MshCell {
  enum class Kind { tetrahedron, triangle, other };
  int code;
  std::string_view name;
  int nodes;
  int dimension;
  Kind kind = Kind::other;
};

constexpr std::size_t kMostMshNodes = 125;

/// The element type with Gmsh's number `code`; null where there is none up to order 4.
[[nodiscard]] const MshCell* msh_cell(std::int64_t code);

/// The place in Gmsh's order of node k of VTK's order, for tetrahedra of 4, 10 or 20 nodes. Of 10
/// nodes Gmsh swaps the last two mid-edge nodes; of 20 nodes it lists some edges backwards.
[[nodiscard]] std::span<const std::size_t> msh_tet_order(std::size_t nodes);

}  // namespace chladni::io
