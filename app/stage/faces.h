// The one rule that says on which faces of a body devices, priors and interpolation are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/study/study.h"
#include "mesh/tet_mesh.h"
#include "placement/rules.h"
#include "placement/sites.h"

namespace chladni::app {

/// What a study's `on` comes to.
struct Faces {
  std::vector<std::string> patches;  ///< named ones
  std::vector<char> looking;  ///< per boundary face 1 where it was chosen by the way it looks;
                              ///< empty: the patches count, or all where there are none either
  std::optional<Eigen::Vector3d> direction;  ///< the way it looks, where that chose
  std::vector<std::string> notes;            ///< what a user should know of the choice
};

/// `on` names patches, or a direction: the faces that look along it (mesh/facing.h). Where it says
/// neither: the patch "top" of a body that is given by its dimensions; else what looks along z,
/// where that is at least a third of what is seen from there; else all faces.
/// @param key  of the study that asks, for messages: "placement.on"
/// @throws InvalidInput  a patch that is not there (lists those there are), or nothing that looks
///                       that way: with file, line and column
[[nodiscard]] Faces faces_of(const Study& study, const mesh::TetMesh& body, const FacePlan& on,
                             const std::string& key);

/// The direction that is asked for, else that of the faces; none: their normals.
template <typename Plan>
[[nodiscard]] std::optional<Eigen::Vector3d> direction_on(const Faces& faces, const Plan& plan) {
  if (plan.direction || plan.along_normal) return plan.direction;
  return faces.direction;
}

/// That direction at every point; n×3, unit.
[[nodiscard]] Points directions_on(const placement::Sites& sites,
                                   const std::optional<Eigen::Vector3d>& direction);

[[nodiscard]] placement::Surface surface_on(const placement::Sampler& sampler, const Faces& faces);

/// The edges of those faces [m].
[[nodiscard]] placement::KeepFromEdges edges_on(const mesh::TetMesh& body, const Faces& faces,
                                                double distance);

/// Everything in the study that names faces of the body, looked up.
/// @param body  may be a shell
/// @throws InvalidInput  patches that are not there, in placement, priors, interpolation, diagnosis
///                       and supports: all at once, with line and column
void require_faces(const Study& study, const mesh::TetMesh& body);

}  // namespace chladni::app
