#include "steps/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "placement/refine.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

constexpr std::size_t kBestShown = 10;

placement::Device device_of(const study::PlacementPlan& plan) {
  return {plan.direction, plan.footprint};
}

// Mean distance between neighbouring points of a surface.
double grain(const placement::Sites& sites) {
  return std::sqrt(sites.area.sum() / static_cast<double>(sites.count()));
}

double diagonal(const Points& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

// Scores of sites; −∞ where a rule forbids a site.
placement::Worth worth_of(const Views& views, const Placed& placed) {
  return [&](const placement::Sites& sites) {
    Eigen::VectorXd score =
        placement::heat_map(*placed.criterion, views.of(sites), views.over()).score;
    const Eigen::VectorXi forbidden = placement::forbidden_by(sites, placed.rules);
    for (Eigen::Index i = 0; i < score.size(); ++i) {
      if (forbidden(i) >= 0) score(i) = -HUGE_VAL;
    }
    return score;
  };
}

BestPair at_its_best(const placement::Sampler& sampler, const Views& views, const Placed& placed,
                     const placement::Sites& start, bool may_move) {
  const auto site = may_move ? placement::refined(sampler, start, worth_of(views, placed),
                                                  0.5 * grain(placed.surface.sites), 5e-5)
                             : start;
  const auto map = placement::heat_map(*placed.criterion, views.of(site), views.over());
  return {site.position.row(0).transpose(), map.score(0), map.limiting(0)};
}

std::vector<Eigen::Index> all_rows(Eigen::Index count) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) rows[static_cast<std::size_t>(i)] = i;
  return rows;
}

// Single pairs on separate hills of the map: at least a twentieth of the body apart.
void add_best(const placement::Sampler& sampler, const Views& views,
              const study::PlacementPlan& plan, const Candidates& candidates, Placed& placed) {
  const auto& sites = candidates.sites;
  const auto map = placement::heat_map(*placed.criterion, views.of(sites), views.over());
  const double apart = std::max(plan.spacing, 0.05 * diagonal(sites.position));
  std::vector<BestPair> found;
  for (const auto row : placement::best_sites(map.score, sites.position, all_rows(sites.count()),
                                              apart, 2 * kBestShown)) {
    found.push_back(
        at_its_best(sampler, views, placed, placement::part(sites, {row}), !candidates.from_grid));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  for (const auto& pair : found) {  // two may have climbed the same hill
    const bool is_new = std::none_of(
        placed.best.begin(), placed.best.end(),
        [&](const auto& other) { return (other.position - pair.position).norm() < 0.99 * apart; });
    if (is_new && placed.best.size() < kBestShown) placed.best.push_back(pair);
  }
  if (plan.pairs < 2) return;
  const auto chosen =
      placement::chosen_pairs(*placed.criterion, views.of(sites), views.over(), sites.position,
                              all_rows(sites.count()), plan.spacing, plan.pairs);
  for (const auto& pair : chosen) {
    placed.pairs.push_back({sites.position.row(pair.site).transpose(), pair.score, pair.limiting});
  }
}

void add_maps(const Views& views, const study::PlacementPlan& plan, Placed& placed) {
  const auto on_surface = views.of(placed.surface.sites);
  for (const auto* criterion : placement::criteria()) {
    if (criterion->name == plan.criterion) {
      placed.criterion = criterion;
      placed.chosen = placed.maps.size();
    }
    placed.maps.push_back(placement::heat_map(*criterion, on_surface, views.over()));
  }
}

}  // namespace

Placed placed(const study::Study& study, const stage::Solution& solution, stage::Work& work) {
  study::PlacementPlan plan = placement_plan(study);
  const auto& body = solution.model.body;
  const auto progress = work.progress();
  tell(progress, "looking at the surface");
  Placed placed;
  placed.faces = stage::faces_of(study, body, plan.on, "placement.on");
  placed.notes = placed.faces.notes;
  plan.direction = stage::direction_on(placed.faces, plan);
  const placement::Sampler sampler(body, solution.modes, device_of(plan));
  work.timed("surface", [&] {
    placed.surface = stage::surface_on(sampler, placed.faces);
    return 0;
  });
  placed.wanted = wanted_modes(study, solution, plan, placed.surface, placed.notes);
  placed.rules = rules_of(study, solution, plan, placed.faces);
  placed.forbidden = placement::forbidden_by(placed.surface.sites, placed.rules);
  tell(progress, "scoring pairs");
  std::vector<stage::Member> members;
  if (plan.uncertainty) members = stage::ensemble(solution, *plan.uncertainty, work.seed());
  const Views views(study, solution, plan, placed.surface, placed.wanted, std::move(members));
  const Candidates candidates = candidates_of(plan, sampler, placed);
  work.timed("heat_map", [&] {
    add_maps(views, plan, placed);
    add_best(sampler, views, plan, candidates, placed);
    return 0;
  });
  tell(progress, "scoring layouts");
  work.timed("layouts", [&] {
    add_optima(study, solution, plan, candidates, work.seed(), placed);
    add_layouts(study, solution, plan, placed);
    return 0;
  });
  return placed;
}

std::string group_name(const stage::Solution& solution, const WantedModes& wanted, int group) {
  const auto [first, size] = wanted.groups[static_cast<std::size_t>(group)];
  const auto column = wanted.columns[static_cast<std::size_t>(first)];
  const auto flexible = column - solution.modes.rigid_count + 1;
  const double frequency = solution.modes.frequency_hz(column);
  if (size == 1) return fmt::format("{} (flex {}, {:.2f} Hz)", column + 1, flexible, frequency);
  return fmt::format("{}-{} (flex {}-{}, {:.2f} Hz)", column + 1, column + size, flexible,
                     flexible + size - 1, frequency);
}

}  // namespace chladni::steps
