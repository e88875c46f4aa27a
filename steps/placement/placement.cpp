#include "steps/placement.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "fem/system.h"
#include "io/scan.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

placement::Candidates candidates_of(const study::PlacementPlan& plan,
                                    const placement::Sampler& sampler, const BestPlaces& places) {
  if (!plan.grid) return placement::candidates_on(places.surface, places.rules);
  const auto& grid = *plan.grid;
  return placement::candidates_on({grid.pitch, grid.centre, grid.columns, grid.rows}, sampler,
                                  places.surface, places.rules);
}

void require_flexible_mode(const study::Study& study, const modal::Modes& modes) {
  require(modes.mode_count() > modes.rigid_count,
          study.file.string() + ": placement needs a flexible mode");
}

// Channels of the study, in quotes, that do not point as devices at the nearest of the sites would.
std::vector<std::string> pointing_elsewhere(const std::vector<study::Channel>& channels,
                                            const std::vector<mesh::Site>& at,
                                            const placement::Sites& sites,
                                            const Points& directions) {
  constexpr double kAlong = 0.9;  // cosine of the angle
  std::vector<std::string> names;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    Eigen::Index nearest = 0;
    (sites.position.rowwise() - at[i].position.transpose())
        .rowwise()
        .squaredNorm()
        .minCoeff(&nearest);
    const double along = directions.row(nearest).dot(channels[i].direction.transpose());
    if (std::abs(along) < kAlong) names.push_back("\"" + channels[i].name + "\"");
  }
  return names;
}

// The study leaves the direction open, and its channels have others than the faces.
void note_directions(const study::Study& study, const stage::Model& model,
                     const placement::Sites& sites, const std::optional<Eigen::Vector3d>& direction,
                     std::vector<std::string>& notes) {
  const auto stated = placement_plan(study);
  if (stated.direction || stated.along_normal || sites.position.rows() == 0) return;
  const auto directions = stage::directions_on(sites, direction);
  auto names = pointing_elsewhere(study.sensors, model.sensors, sites, directions);
  for (auto& name : pointing_elsewhere(study.actuators, model.actuators, sites, directions)) {
    names.push_back(std::move(name));
  }
  if (names.empty()) return;
  const auto along = direction ? fmt::format("({:.3g}, {:.3g}, {:.3g})", direction->x() + 0.0,
                                             direction->y() + 0.0, direction->z() + 0.0)
                               : std::string("the surface's normal");
  notes.push_back(
      fmt::format("places are sought for devices along {}, and {} of the study {} "
                  "elsewhere; placement.direction = \"x\" seeks those along x",
                  along, io::listed(names), names.size() == 1 ? "points" : "point"));
}

// Modes that placement.up_to asks for and that were not computed.
void note_modes_above(const study::Study& study, const modal::Modes& modes,
                      const study::PlacementPlan& plan, std::vector<std::string>& notes) {
  if (plan.up_to_hz <= 0.0 || study.modes.up_to_hz > 0.0) return;
  const double last = modes.frequency_hz(modes.mode_count() - 1);
  if (last >= plan.up_to_hz) return;
  notes.push_back(
      fmt::format("placement.up_to is {:.6g} Hz, but the last mode that was computed lies at "
                  "{:.6g} Hz: those above it are not looked at; modes.up_to computes them",
                  plan.up_to_hz, last));
}

// The part of each mode's kinetic energy in motions of the whole body that only springs resist: 1
// where the body moves on its springs without bending.
Eigen::VectorXd suspended_part(const stage::Solution& solution) {
  const auto& system = *solution.system;
  const auto& shapes = solution.modes.shapes;
  if (system.suspended.cols() == 0) return Eigen::VectorXd::Zero(shapes.cols());
  const Eigen::MatrixXd momentum = system.mass.selfadjointView<Eigen::Lower>() * system.suspended;
  return (fem::on_nodes(system.dofs, momentum).transpose() * shapes).colwise().squaredNorm();
}

// Modes of the suspension count as flexible ones, which the study may not mean.
void note_suspension(const stage::Solution& solution, const placement::WantedModes& wanted,
                     std::vector<std::string>& notes) {
  constexpr double kOnSprings = 0.5;
  const Eigen::VectorXd part = suspended_part(solution);
  const auto& modes = solution.modes;
  const auto on_springs = [&](Eigen::Index mode) { return part(mode) > kOnSprings; };
  if (std::ranges::none_of(wanted.columns, on_springs)) return;
  std::vector<std::string> numbers;
  std::vector<Eigen::Index> bending;  // the first three
  for (Eigen::Index m = modes.rigid_count; m < modes.mode_count(); ++m) {
    const bool is_wanted = std::ranges::find(wanted.columns, m) != wanted.columns.end();
    if (is_wanted && on_springs(m)) {
      numbers.push_back(fmt::format("{} ({:.4g} Hz)", m + 1, modes.frequency_hz(m)));
    }
    if (!on_springs(m) && bending.size() < 3) bending.push_back(m - modes.rigid_count + 1);
  }
  const auto advice = bending.empty()
                          ? "a larger modes.count computes some that bend it"
                          : fmt::format("placement.modes = [{}] asks for the first that bend it",
                                        fmt::join(bending, ", "));
  notes.push_back(fmt::format(
      "in mode {} the body moves on its springs and does not bend, and places are sought for {} "
      "all the same; {}",
      io::listed(numbers), numbers.size() == 1 ? "it" : "them", advice));
}

}  // namespace

BestPlaces best_places(const study::Study& study, const stage::Solution& solution,
                       stage::Work& work) {
  study::PlacementPlan own = placement_plan(study);
  const auto& body = solution.model.body;
  require_flexible_mode(study, solution.modes);
  const auto progress = work.progress();
  tell(progress, "looking at the surface");
  BestPlaces places;
  places.faces = stage::faces_of(study, body, own.on, "placement.on");
  places.notes = places.faces.notes;
  own.direction = stage::direction_on(places.faces, own);
  const placement::Sampler sampler(body, solution.modes, {own.direction, own.footprint});
  work.timed("surface", [&] {
    places.surface = stage::surface_on(sampler, places.faces);
    return 0;
  });
  note_directions(study, solution.model, places.surface.sites, own.direction, places.notes);
  note_modes_above(study, solution.modes, own, places.notes);
  const auto structure = structure_of(study, solution, own, work.seed());
  auto plan = room_plan(own, structure);
  const auto& surface = places.surface.sites;
  if (own.observer) {
    plan.observer = observer_task(study, solution, own, structure, surface, places.notes);
  }
  places.wanted = placement::wanted_modes(structure, surface, plan, places.notes);
  note_suspension(solution, places.wanted, places.notes);
  places.rules = rules_of(body, own, structure, places.faces);
  places.forbidden = placement::forbidden_by(surface, places.rules);
  tell(progress, "scoring pairs");
  const auto candidates = candidates_of(own, sampler, places);
  work.timed("heat_map", [&] {
    const placement::PairViews views(structure, surface, places.wanted, plan);
    static_cast<placement::PairPlaces&>(places) =
        placement::best_pairs(views, surface, candidates, plan, &sampler, places.rules);
    return 0;
  });
  tell(progress, "scoring layouts");
  work.timed("layouts", [&] {
    places.optima =
        placement::best_layouts(structure, surface, candidates, places.wanted, plan, work.seed());
    add_layouts(study, solution, structure, plan, places);
    return 0;
  });
  return places;
}

}  // namespace chladni::steps
