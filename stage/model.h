// A study on its mesh: materials by region, and the places of all its parts on the body.
#pragma once

#include <string>
#include <vector>

#include "fem/assemble.h"
#include "io/vtu.h"
#include "mesh/site.h"
#include "mesh/tet_mesh.h"
#include "study/study.h"

namespace chladni::stage {

struct Model {
  mesh::TetMesh body;
  std::vector<fem::Material> materials;  ///< one per region
  std::vector<fem::Attachment> attachments;
  std::vector<mesh::Site> sensors, actuators;  ///< in the order of the study's channels
  fem::MassProperties mass;
  std::vector<std::string> notes;     ///< channels that were moved onto the body
  std::vector<std::string> warnings;  ///< channels inside the body; points that turn; footprints
};

/// Places of the channels and attachments of a study.
struct Places {
  std::vector<mesh::Site> sensors, actuators, attachments;
  std::vector<mesh::Site> link_ends;  ///< one per attachment; empty sites except for links
  std::vector<std::string> notes, warnings;
};

/// Places on the boundary of `body`, which may be a shell without cells. A place inside the body
/// moves to the nearest point of the boundary, with a warning.
/// @throws InvalidInput  places farther off the body than `reach_of`: their distances, all at once
[[nodiscard]] Places places_of(const study::Study& study, const mesh::TetMesh& body);

/// The material of a region: the one that names it, else the one without region; null: none.
[[nodiscard]] const study::StudyMaterial* material_for(const study::Study& study,
                                                       const std::string& region);

/// One material per region. @throws InvalidInput  a region has none, or a material has no region
[[nodiscard]] std::vector<fem::Material> materials_of(const study::Study& study,
                                                      const std::vector<std::string>& regions);

[[nodiscard]] Model model_of(const study::Study& study, mesh::TetMesh body);

/// Channels and attachments as glyphs.
[[nodiscard]] std::vector<io::Marker> markers_of(const study::Study& study, const Model& model);

}  // namespace chladni::stage
