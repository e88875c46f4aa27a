#include "stage/faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "mesh/facing.h"
#include "mesh/surface.h"
#include "study/problems.h"

namespace chladni::stage {
namespace {

constexpr double kMostOfIt = 1.0 / 3.0;  // of the silhouette: a ball's cap is a quarter of it
constexpr double kThinBody = 0.5;        // ratio of two sides

bool has_patch(const mesh::TetMesh& body, const std::string& name) {
  const auto& names = body.patch_names;
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string no_patch(const mesh::TetMesh& body, const std::string& key, const std::string& name) {
  constexpr std::size_t kMost = 30;
  const auto& names = body.patch_names;
  const std::vector<std::string> first(
      names.begin(), names.begin() + std::min<std::ptrdiff_t>(std::ssize(names), kMost));
  const std::string near = study::nearest_name(name, names);
  return fmt::format("{}: the body has no patch \"{}\"{}; there are: {}{}", key, name,
                     near.empty() ? "" : ", did you mean \"" + near + "\"?", fmt::join(first, ", "),
                     names.size() > kMost ? fmt::format(" and {} more", names.size() - kMost) : "");
}

std::string axis_text(const Eigen::Vector3d& direction) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction(k)) < 1.0 - 1e-12) continue;
    return fmt::format("{}{}", direction(k) < 0.0 ? "-" : "", "xyz"[k]);
  }
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", direction(0), direction(1), direction(2));
}

std::string looking_text(const std::string& key, const Eigen::Vector3d& direction,
                         const mesh::Facing& found) {
  const std::string left =
      found.small_parts > 0 ? fmt::format("; {} small parts left out", found.small_parts) : "";
  return fmt::format(
      "{}: the face that looks along {}, {:.6g} cm2 of the {:.6g} cm2 seen from there{}", key,
      axis_text(direction), 1e4 * found.area, 1e4 * found.silhouette, left);
}

// Notes a plate that does not lie flat: the faces along z may be its rim.
void note_thin(const mesh::TetMesh& body, const std::string& key, Faces& faces) {
  const auto box = mesh::bounding_box(body.points);
  const Eigen::RowVector3d size = box.row(1) - box.row(0);
  Eigen::Index thin = 0;
  if (size.minCoeff(&thin) > kThinBody * size(2) || thin == 2) return;
  const char axis = "xyz"[thin];
  faces.notes.push_back(fmt::format(
      "{}: the body is thinnest along {}, and what looks along z is taken; if its large "
      "face is meant: on = {{ facing = \"{}\" }}",
      key, axis, axis));
}

Faces looking(const Eigen::Vector3d& direction, mesh::Facing found, const std::string& key) {
  Faces faces;
  faces.direction = direction;
  faces.notes.push_back(looking_text(key, direction, found));
  faces.looking = std::move(found.face);
  return faces;
}

// The faces if the study names none.
Faces upper_faces(const study::Study& study, const mesh::TetMesh& body, const std::string& key) {
  Faces faces;
  if (study.geometry.kind != "file" && has_patch(body, "top")) {
    faces.patches = {"top"};
    return faces;
  }
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  auto found = mesh::facing(body, up);
  if (found.area >= kMostOfIt * found.silhouette && !found.empty()) {
    faces = looking(up, std::move(found), key);
    note_thin(body, key, faces);
    return faces;
  }
  if (study.geometry.kind == "file") {
    faces.notes.push_back(key +
                          ": no face looks up along z, all of the surface is taken; name patches, "
                          "on = [\"...\"], or a direction, on = { facing = \"x\" }");
  }
  return faces;
}

// The faces that the study asks for; errors go to `problems`.
Faces asked_faces(const mesh::TetMesh& body, const study::FacePlan& on, const std::string& key,
                  study::Problems& problems) {
  if (on.facing) {
    auto found = mesh::facing(body, *on.facing);
    if (!found.empty()) return looking(*on.facing, std::move(found), key);
    problems.add(on.line, on.column,
                 fmt::format("{}: nothing of the body looks along {} within {:.0f} degrees", key,
                             axis_text(*on.facing), mesh::kFacingDegrees));
  }
  Faces faces;
  faces.patches = on.patches;
  for (const auto& name : on.patches) {
    if (!has_patch(body, name)) problems.add(on.line, on.column, no_patch(body, key, name));
  }
  return faces;
}

// Per patch 1 where it has a face on the outside of the body.
std::vector<char> outer_patches(const mesh::TetMesh& body) {
  std::vector<char> outer(body.patch_names.size(), 0);
  for (const int patch : body.face_patch) outer[static_cast<std::size_t>(patch)] = 1;
  return outer;
}

// A support on a patch that does not exist, or between two regions, would hold nothing.
void look_at_supports(const study::Study& study, const mesh::TetMesh& body,
                      study::Problems& problems) {
  if (study.supports.empty()) return;
  const auto outer = outer_patches(body);
  for (std::size_t i = 0; i < study.supports.size(); ++i) {
    const auto& patch = study.supports[i].patch;
    const auto& names = body.patch_names;
    const auto found = std::find(names.begin(), names.end(), patch) - names.begin();
    if (found == std::ssize(names)) {
      problems.add(study.support_lines[i], 1, no_patch(body, "support.patch", patch));
    } else if (outer[static_cast<std::size_t>(found)] == 0) {
      problems.add(study.support_lines[i], 1,
                   fmt::format("support.patch: no face of \"{}\" is on the outside of the body; "
                               "between two regions a support holds nothing",
                               patch));
    }
  }
}

}  // namespace

Faces faces_of(const study::Study& study, const mesh::TetMesh& body, const study::FacePlan& on,
               const std::string& key) {
  if (on.empty()) return upper_faces(study, body, key);
  study::Problems problems(study.file.string());
  auto faces = asked_faces(body, on, key, problems);
  problems.throw_if_any();
  return faces;
}

Points directions_on(const placement::Sites& sites,
                     const std::optional<Eigen::Vector3d>& direction) {
  if (!direction) return sites.normal;
  return direction->transpose().replicate(sites.count(), 1);
}

placement::Surface surface_on(const placement::Sampler& sampler, const Faces& faces) {
  return faces.looking.empty() ? sampler.surface(faces.patches)
                               : sampler.smooth_surface(faces.looking);
}

placement::KeepFromEdges edges_on(const mesh::TetMesh& body, const Faces& faces, double distance) {
  return faces.looking.empty() ? placement::edges_of(body, faces.patches, distance)
                               : placement::edges_around(body, faces.looking, false, distance);
}

void require_faces(const study::Study& study, const mesh::TetMesh& body) {
  study::Problems problems(study.file.string());
  const auto look = [&](const auto& plan, const char* key) {
    if (plan) static_cast<void>(asked_faces(body, plan->on, key, problems));
  };
  look_at_supports(study, body, problems);
  look(study.placement, "placement.on");
  look(study.interpolation, "interpolation.on");
  look(study.priors, "priors.on");
  look(study.diagnosis, "diagnosis.on");
  if (study.placement) {
    const auto look_at = [&](const std::vector<study::KeepOut>& zones, const std::string& key) {
      for (const auto& zone : zones) {
        if (zone.shape != "patch" || has_patch(body, zone.patch)) continue;
        problems.add(zone.line, zone.column, no_patch(body, key, zone.patch));
      }
    };
    look_at(study.placement->keep_out, "placement.keep_out");
    const auto& observer = study.placement->observer;
    if (observer) look_at(observer->region, "placement.observer.region");
  }
  problems.throw_if_any();
}

}  // namespace chladni::stage
