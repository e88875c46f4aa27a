#include "stage/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "stage/points_on_body.h"
#include "stage/variation.h"
#include "study/problems.h"

namespace chladni::stage {
namespace {

constexpr double kMovedSilently = 1e-9;  // [m], rounding error

std::string millimetres(const Eigen::Vector3d& point, bool two) {
  const Eigen::Vector3d mm = 1e3 * point;
  return two ? fmt::format("({:.6g}, {:.6g}) mm", mm(0), mm(1))
             : fmt::format("({:.6g}, {:.6g}, {:.6g}) mm", mm(0), mm(1), mm(2));
}

/// Finds places one after the other and collects those that are not on the body.
class Placing {
 public:
  Placing(const study::Study& study, const mesh::TetMesh& body)
      : file_(study.file.string()), body_(body), problems_(file_) {}

  mesh::Site site(const std::string& what, const study::Place& place) {
    const Eigen::Vector3d& wanted = place.point;
    if (!finder_) finder_.emplace(body_);  // takes its time on a fine mesh
    auto site = site_at(*finder_, place);
    const double off = site.distance;
    const std::string found = fmt::format("{} at {} is {:.4g} mm off the body; nearest is {}", what,
                                          millimetres(place.point, place.from_above), 1e3 * off,
                                          millimetres(site.position, place.from_above));
    const bool inside = !place.from_above && site.normal.dot(wanted - site.position) < -0.9 * off;
    if (off > kOnTheBody && inside) {
      warnings_.push_back(
          fmt::format("{}:{}: {} at {} is {:.4g} mm inside the body; the nearest "
                      "place of its surface, {}, is taken instead",
                      file_, place.line, what, millimetres(place.point, false), 1e3 * off,
                      millimetres(site.position, false)));
    } else if (off > kOnTheBody) {
      problems_.add(place.line, 1, found);
    } else if (off > kMovedSilently) {
      notes_.push_back(found + ", taken instead");
    }
    return site;
  }

  void finish(Places& places) {
    problems_.throw_if_any();
    places.notes = std::move(notes_);
    places.warnings = std::move(warnings_);
  }

 private:
  std::string file_;
  const mesh::TetMesh& body_;
  std::optional<mesh::SiteFinder> finder_;
  study::Problems problems_;
  std::vector<std::string> notes_, warnings_;
};

std::vector<mesh::Site> sites_of(Placing& placing, const std::string& kind,
                                 const std::vector<study::Channel>& channels) {
  std::vector<mesh::Site> sites;
  sites.reserve(channels.size());
  for (const auto& channel : channels) {
    sites.push_back(placing.site(kind + " \"" + channel.name + "\"", channel.at));
  }
  return sites;
}

void add_channels(std::vector<io::Marker>& markers, const std::string& kind,
                  const std::vector<study::Channel>& channels,
                  const std::vector<mesh::Site>& sites) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    markers.push_back({channels[i].name, kind, sites[i].position, channels[i].direction});
  }
}

/// The direction in which an attachment acts; up for a mass.
Eigen::Vector3d direction_of(const fem::Attachment& attachment) {
  if (const auto* spring = std::get_if<fem::GroundSpring>(&attachment.what))
    return spring->direction;
  if (const auto* spring = std::get_if<fem::GroundTorsionSpring>(&attachment.what)) {
    return spring->axis;
  }
  if (const auto* resonator = std::get_if<fem::Resonator>(&attachment.what)) {
    return resonator->direction;
  }
  if (const auto* link = std::get_if<fem::LinkSpring>(&attachment.what)) {
    return (link->other.position - attachment.site.position).stableNormalized();
  }
  return Eigen::Vector3d::UnitZ();
}

// A moment at one point of a solid turns it without bound: what holds there is the element.
void warn_of_turned_points(const study::Study& study, std::vector<std::string>& warnings) {
  for (const auto& plan : study.attachments) {
    const auto* mass = std::get_if<fem::PointMass>(&plan.what);
    if (mass == nullptr || plan.footprint > 0.0 || mass->inertia.isZero(0.0)) continue;
    warnings.push_back(fmt::format(
        "attachment \"{}\": its inertia turns a single point of the body, which holds it the less "
        "the finer the mesh is: its modes are the mesh's. Give the diameter over which it is "
        "fixed, such as footprint = \"20 mm\"",
        plan.name));
  }
}

}  // namespace

Places places_of(const study::Study& study, const mesh::TetMesh& body) {
  Placing placing(study, body);
  Places places;
  places.sensors = sites_of(placing, "sensor", study.sensors);
  places.actuators = sites_of(placing, "actuator", study.actuators);
  for (const auto& plan : study.attachments) {
    const std::string what = "attachment \"" + plan.name + "\"";
    places.attachments.push_back(placing.site(what, plan.at));
    places.link_ends.push_back(plan.to ? placing.site("the end of " + what, *plan.to)
                                       : mesh::Site{});
  }
  placing.finish(places);
  warn_of_turned_points(study, places.warnings);
  return places;
}

const study::StudyMaterial* material_for(const study::Study& study, const std::string& region) {
  const study::StudyMaterial* found = nullptr;
  for (const auto& material : study.materials) {
    if (material.region == region || (material.region.empty() && found == nullptr)) {
      found = &material;
    }
  }
  return found;
}

std::vector<fem::Material> materials_of(const study::Study& study,
                                        const std::vector<std::string>& regions) {
  for (const auto& material : study.materials) {
    const bool used = material.region.empty() ||
                      std::find(regions.begin(), regions.end(), material.region) != regions.end();
    require(used, study.file.string() + ": a material names region \"" + material.region +
                      "\"; the body has " + study::listed(regions));
  }
  std::vector<fem::Material> materials;
  for (const auto& region : regions) {
    const auto* found = material_for(study, region);
    require(found != nullptr, study.file.string() + ": region \"" + region +
                                  "\" has no material; add one with region = \"" + region +
                                  "\" or one without region");
    materials.push_back(found->material);
  }
  return materials;
}

Model model_of(const study::Study& study, mesh::TetMesh body) {
  Model model;
  model.body = std::move(body);
  model.materials = materials_of(study, model.body.region_names);
  vary(study, model.body, model.materials);
  auto places = places_of(study, model.body);
  model.sensors = std::move(places.sensors);
  model.actuators = std::move(places.actuators);
  model.notes = std::move(places.notes);
  model.warnings = std::move(places.warnings);
  for (std::size_t i = 0; i < study.attachments.size(); ++i) {
    const auto& plan = study.attachments[i];
    fem::Attachment attachment{plan.name, places.attachments[i], plan.footprint, plan.what};
    if (auto* link = std::get_if<fem::LinkSpring>(&attachment.what)) {
      link->other = places.link_ends[i];
    }
    model.attachments.push_back(std::move(attachment));
  }
  model.mass = fem::mass_properties(model.body, model.materials, model.attachments);
  return model;
}

std::vector<io::Marker> markers_of(const study::Study& study, const Model& model) {
  std::vector<io::Marker> markers;
  add_channels(markers, "sensor", study.sensors, model.sensors);
  add_channels(markers, "actuator", study.actuators, model.actuators);
  for (std::size_t i = 0; i < study.attachments.size(); ++i) {
    const auto& attachment = model.attachments[i];
    markers.push_back({attachment.name, study.attachments[i].kind, attachment.site.position,
                       direction_of(attachment)});
  }
  return markers;
}

}  // namespace chladni::stage
