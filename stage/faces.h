// The common rule for the faces of a body that devices, priors and interpolation use.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"
#include "placement/rules.h"
#include "placement/sites.h"
#include "study/study.h"

namespace chladni::stage {

/// The faces that a study's `on` selects.
struct Faces {
  std::vector<std::string> patches;  ///< named patches
  std::vector<char> looking;  ///< per boundary face 1 if it was chosen by its direction; empty: the
                              ///< patches count, or all faces if there are none
  std::optional<Eigen::Vector3d> direction;  ///< the direction, if it chose the faces
  std::vector<std::string> notes;            ///< notes for the user about the choice
};

/// `on` names patches, or a direction: the faces that look along it (mesh/facing.h). If it names
/// neither: the patch "top" of a body that is given by its dimensions; else the faces that look
/// along z, if they are at least a third of the silhouette; else all faces.
/// @param key  of the study, for messages: "placement.on"
/// @throws InvalidInput  a patch that does not exist (lists those that do), or no face in that
///                       direction: with file, line and column
[[nodiscard]] Faces faces_of(const study::Study& study, const mesh::TetMesh& body,
                             const study::FacePlan& on, const std::string& key);

/// The direction of the plan, else that of the faces; none: their normals.
template <typename Plan>
[[nodiscard]] std::optional<Eigen::Vector3d> direction_on(const Faces& faces, const Plan& plan) {
  if (plan.direction || plan.along_normal) return plan.direction;
  return faces.direction;
}

/// The direction at every point; n×3, unit.
[[nodiscard]] Points directions_on(const placement::Sites& sites,
                                   const std::optional<Eigen::Vector3d>& direction);

[[nodiscard]] placement::Surface surface_on(const placement::Sampler& sampler, const Faces& faces);

/// The edges of those faces [m].
[[nodiscard]] placement::KeepFromEdges edges_on(const mesh::TetMesh& body, const Faces& faces,
                                                double distance);

/// Checks everything in the study that names faces of the body.
/// @param body  may be a shell
/// @throws InvalidInput  patches that do not exist, in placement, priors, interpolation, diagnosis
///                       and supports, and supports on patches between two regions: all together,
///                       with line and column
void require_faces(const study::Study& study, const mesh::TetMesh& body);

}  // namespace chladni::stage
