// VTK unstructured grids: meshes and modes for ParaView, as compressed appended binary data.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"
#include "modal/modes.h"

namespace chladni::io {

/// A named field on the mesh's nodes: 3·nodes rows x0 y0 z0 x1 ... (a vector) or nodes rows.
struct NodeField {
  std::string name;
  Eigen::VectorXd values;
};

/// A point with a name and a direction, drawn as a glyph.
struct Marker {
  std::string name;
  std::string kind;  ///< "sensor", "actuator", "mass", "spring", ...
  Eigen::Vector3d position;
  Eigen::Vector3d direction;
};

/// Title and units of a file, written as the string arrays "title" and "units" of its field data.
struct Units {
  std::string title;
  std::vector<std::string> lines{"length: m"};  ///< "displacement: m"
};

/// The name of a mode's array: mode_007_178.92Hz, counted from 1 with the rigid-body modes.
[[nodiscard]] std::string mode_name(Eigen::Index index, double frequency_hz);

/// Writes the mesh with quadratic cells (linear where the mesh is linear). The cell array "region"
/// is the index into the field data "region_names". Where the boundary has patches, the point array
/// "patch" is the index into the field data "patch_names", from 0 (-1 inside the body, the smaller
/// patch on a border). Each field has a point array. There is field data "units" and, if given,
/// "title". A cubic mesh is written as quadratic cells with the cubic fields evaluated at the
/// mid-edge nodes. Floats have 64 bits, so a shape read back gives the same MAC and mass. The same
/// input gives the same bytes.
/// @throws as write_atomically
/// @throws InvalidInput  a field has neither nodes nor 3·nodes rows (names it)
void write_vtu(const std::filesystem::path& file, const mesh::TetMesh& mesh,
               const std::vector<NodeField>& fields, const Units& units = {});

/// Like write_vtu, with one vector array per mode; shapes are on all nodes (3·nodes rows). Field
/// data: "title" if given, "units", "frequency_hz" (one value per mode), "region_names".
void write_modes_vtu(const std::filesystem::path& file, const mesh::TetMesh& mesh,
                     const modal::Modes& modes, const std::string& title = {});

/// Writes a phase animation of mode `index` in `frames` steps, as `<stem>_NN.vtu` beside `file`
/// (.pvd). The nodes themselves move; the largest motion is 6 % of the body's diagonal.
void write_animation(const std::filesystem::path& file, const mesh::TetMesh& mesh,
                     const modal::Modes& modes, Eigen::Index index, int frames = 24);

/// Writes triangles with one value per point and field. @throws as write_vtu
void write_surface_vtu(const std::filesystem::path& file, const Points& points,
                       const Cells& triangles, const std::vector<NodeField>& fields,
                       const Units& units = {});

/// Writes vertices with the string arrays "name" and "kind" and the vectors "direction".
void write_markers_vtu(const std::filesystem::path& file, const std::vector<Marker>& markers);

/// Reads the tetrahedra (4, 10 or 20 nodes) of a .vtu; other solid cells are refused. VTK reads the
/// file in a worker, because on broken files its reader crashes or returns an empty grid without an
/// error. Regions follow the cell array "region" where there is one. The boundary is found and its
/// patches are named.
/// @param notes  of what was dropped or turned is appended, if given
/// @throws InvalidInput  not such a file, or a damaged one; names what was found
/// @throws WorkerDied    the program chladni-vtu is missing
[[nodiscard]] mesh::TetMesh read_vtu(const std::filesystem::path& file,
                                     std::vector<std::string>* notes = nullptr);

}  // namespace chladni::io
