// Pictures of mode shapes, painted by VTK in a separate program (on its own Xvfb).
#pragma once

#include <string>
#include <vector>

#include "fem/modes.h"
#include "io/picture_file.h"
#include "io/vtu.h"
#include "mesh/tet_mesh.h"
#include "modal/modes.h"

namespace chladni::io {

/// Draws a contact sheet of the first `count` flexible modes. Each panel shows the deformed body
/// with number and frequency of the mode and with the markers. The colour is the displacement along
/// the mode's main axis (zero white, nodal lines black). PNG, 1400 px wide; the same input gives
/// the same bytes. About 1 s.
/// @param modes     shapes on all nodes: 3·nodes rows
/// @param clusters  repeated modes, marked "pair"
/// @throws InvalidInput  there is no flexible mode, or the shapes do not fit the mesh
/// @throws WorkerDied    the painter or Xvfb is missing or died (says which package)
void draw_modes(const PictureFile& png, const mesh::TetMesh& mesh, const modal::Modes& modes,
                const std::string& title, const std::vector<Marker>& markers = {}, int count = 9,
                const std::vector<fem::Cluster>& clusters = {});

}  // namespace chladni::io
