#include "stage/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "base/error.h"
#include "placement/candidates.h"
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
      : file_(study.file.string()), body_(body), reach_(reach_of(body)), problems_(file_) {}

  mesh::Site site(const std::string& what, const study::Place& place) {
    const Eigen::Vector3d& wanted = place.point;
    if (!finder_) finder_.emplace(body_);  // takes its time on a fine mesh
    auto site = site_at(*finder_, place);
    const double off = site.distance;
    const std::string found = fmt::format("{} at {} is {:.4g} mm off the body; nearest is {}", what,
                                          millimetres(place.point, place.from_above), 1e3 * off,
                                          millimetres(site.position, place.from_above));
    const bool inside = !place.from_above && site.normal.dot(wanted - site.position) < -0.9 * off;
    if (off > reach_ && inside) {
      warnings_.push_back(
          fmt::format("{}:{}: {} at {} is {:.4g} mm inside the body; the nearest "
                      "place of its surface, {}, is taken instead",
                      file_, place.line, what, millimetres(place.point, false), 1e3 * off,
                      millimetres(site.position, false)));
    } else if (off > reach_) {
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
  double reach_;  // [m]
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

// The softest shear modulus [Pa].
double shear_modulus(const study::Study& study) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& material : study.materials) {
    least = std::min(least, material.material.stiffness.diagonal().tail<3>().minCoeff());
  }
  return least;
}

// What at a single point the mesh holds and not the body, whose point gives way without bound;
// empty: nothing. Against G h and G h^3 of a cell of length h springs below these shares are soft:
// they move frequencies by less than a hundredth of themselves, from one mesh to a finer one.
std::string held_by_the_mesh(const study::AttachmentPlan& plan, double shear, double h) {
  constexpr double kSoft = 0.1;
  constexpr double kSoftTurn = 3e-3;
  const auto* mass = std::get_if<fem::PointMass>(&plan.what);
  if (mass != nullptr && !mass->inertia.isZero(0.0)) return "its inertia turns";
  const auto* turn = std::get_if<fem::GroundTorsionSpring>(&plan.what);
  if (turn != nullptr && turn->stiffness > kSoftTurn * shear * h * h * h) return "its spring turns";
  const auto* ground = std::get_if<fem::GroundSpring>(&plan.what);
  const auto* link = std::get_if<fem::LinkSpring>(&plan.what);
  const double stiffness = ground != nullptr ? ground->stiffness
                           : link != nullptr ? link->stiffness
                                             : 0.0;
  return stiffness > kSoft * shear * h ? "its spring holds" : "";
}

double edge_at(const mesh::TetMesh& body, const mesh::Site& site) {
  double sum = 0.0;
  for (const auto& [a, b] : mesh::kTriangleEdges) {
    sum += (body.points.row(site.nodes(a)) - body.points.row(site.nodes(b))).norm();
  }
  return sum / 3.0;
}

void warn_of_single_points(const study::Study& study, const mesh::TetMesh& body, Places& places) {
  const double shear = shear_modulus(study);
  for (std::size_t i = 0; i < study.attachments.size(); ++i) {
    const auto& plan = study.attachments[i];
    if (plan.footprint > 0.0) continue;
    double edge = edge_at(body, places.attachments[i]);
    if (plan.to) edge = std::min(edge, edge_at(body, places.link_ends[i]));
    const auto what = held_by_the_mesh(plan, shear, edge);
    if (what.empty()) continue;
    places.warnings.push_back(fmt::format(
        "attachment \"{}\": {} a single point of the body, which holds it the less the finer the "
        "mesh is: its modes are the mesh's. Give the diameter over which it is fixed, such as "
        "footprint = \"20 mm\"",
        plan.name, what));
  }
}

// What of a footprint lies beyond an edge is left out of it.
void warn_of_footprints(const study::Study& study, const mesh::TetMesh& body, Places& places) {
  constexpr double kWhole = 0.98;
  for (std::size_t i = 0; i < study.attachments.size(); ++i) {
    const auto& plan = study.attachments[i];
    double on = fem::footprint_on_body(body, places.attachments[i], plan.footprint);
    if (plan.to) {
      on = std::min(on, fem::footprint_on_body(body, places.link_ends[i], plan.footprint));
    }
    if (on >= kWhole) continue;
    places.warnings.push_back(fmt::format(
        "attachment \"{}\": {:.0f} % of its footprint of {:.6g} mm lies on the body; the rest is "
        "left out, and what it does acts on that part",
        plan.name, 100.0 * on, 1e3 * plan.footprint));
  }
}

// Places of a mounting grid beyond the body are no candidates. Empty: all are on it.
std::string off_the_grid(const study::GridPlan& grid, const mesh::TetMesh& body) {
  const mesh::SiteFinder finder(body);
  const auto places = placement::places_of({grid.pitch, grid.centre, grid.columns, grid.rows});
  const auto off = std::ranges::count_if(
      places, [&](const auto& at) { return !finder.from_above(at.x(), at.y()); });
  if (off == 0) return {};
  return fmt::format("placement.grid: {} of its {} places are not on the body and are left out",
                     off, places.size());
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
  warn_of_single_points(study, body, places);
  warn_of_footprints(study, body, places);
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
  if (study.placement && study.placement->grid) {
    const auto off = off_the_grid(*study.placement->grid, model.body);
    if (!off.empty()) model.notes.push_back(off);
  }
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
