#include "steps/placement.h"

#include "base/error.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

placement::Candidates candidates_of(const study::PlacementPlan& plan,
                                    const placement::Sampler& sampler, const BestPlaces& places) {
  if (!plan.grid) return placement::candidates_on(places.surface, places.rules);
  const auto& grid = *plan.grid;
  return placement::candidates_on({grid.pitch, grid.centre, grid.columns, grid.rows}, sampler,
                                  places.rules);
}

void require_flexible_mode(const study::Study& study, const modal::Modes& modes) {
  require(modes.mode_count() > modes.rigid_count,
          study.file.string() + ": placement needs a flexible mode");
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
  const auto structure = structure_of(study, solution, own, work.seed());
  auto plan = room_plan(own, structure);
  const auto& surface = places.surface.sites;
  if (own.observer) {
    plan.observer = observer_task(study, solution, own, structure, surface, places.notes);
  }
  places.wanted = placement::wanted_modes(structure, surface, plan, places.notes);
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
