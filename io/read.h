// Reads geometry from files, by their ending.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::io {

/// Notes about data that a reader dropped, guessed or converted, one line each.
using Notes = std::vector<std::string>;

inline void add_note(Notes* notes, std::string note) {
  if (notes != nullptr) notes->push_back(std::move(note));
}

/// The geometry of a file: a surface that is not yet checked, or tetrahedra.
struct Geometry {
  std::variant<mesh::Surface, mesh::TetMesh> body;
  Notes notes;
};

/// Reads a file. .stl (ASCII or binary, distinguished by size), .off, .ply, .obj and .step/.stp
/// give a Surface (a STEP solid's faces become patches). .msh (Gmsh 2.2, 4.1), .inp (C3D4, C3D10;
/// ELSET and NSET/SURFACE become regions and patches) and .vtu give a TetMesh in our node order
/// with boundary and patches.
/// @param unit  length unit of the numbers, "mm"; required for formats without a unit; for STEP it
///              must be empty or agree
/// @throws InvalidInput  the file is missing, truncated, of another format, has a wrong count, a
///                       solid cell that is no tetrahedron, or NaN; names file and place
[[nodiscard]] Geometry read_geometry(const std::filesystem::path& file, const std::string& unit);

/// One reader per ending, for the tests and fuzzers. Each reads bytes and returns geometry in the
/// file's unit. It appends to `notes`, if given. Counts in the file are not trusted: memory stays
/// below 64 times the bytes. Cost: linear (tetrahedra: n log n).
/// @throws InvalidInput  as read_geometry, without the file's name
[[nodiscard]] mesh::Surface parse_stl(std::string_view bytes, Notes* notes = nullptr);
[[nodiscard]] mesh::Surface parse_off(std::string_view bytes, Notes* notes = nullptr);
[[nodiscard]] mesh::Surface parse_ply(std::string_view bytes, Notes* notes = nullptr);
[[nodiscard]] mesh::Surface parse_obj(std::string_view bytes, Notes* notes = nullptr);
[[nodiscard]] mesh::TetMesh parse_msh(std::string_view bytes, Notes* notes = nullptr);
[[nodiscard]] mesh::TetMesh parse_inp(std::string_view bytes, Notes* notes = nullptr);

}  // namespace chladni::io
