#include "placement/best_pairs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/diagonal.h"
#include "placement/constants.h"
#include "placement/refine.h"

namespace chladni::placement {
namespace {

constexpr std::size_t kBestShown = 10;

// Mean distance between neighbouring points of a surface.
double grain(const Sites& sites) {
  return std::sqrt(sites.area.sum() / static_cast<double>(sites.count()));
}

std::vector<Eigen::Index> all_rows(Eigen::Index count) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(count));
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  return rows;
}

// Scores of sites; −∞ where a rule forbids a site.
Worth worth_of(const PairViews& views, const Criterion& criterion, const std::vector<Rule>& rules) {
  return [&](const Sites& sites) {
    Eigen::VectorXd score = heat_map(criterion, views.at(sites), views.over()).score;
    const Eigen::VectorXi forbidden = forbidden_by(sites, rules);
    for (Eigen::Index i = 0; i < score.size(); ++i) {
      if (forbidden(i) >= 0) score(i) = -HUGE_VAL;
    }
    return score;
  };
}

// The pairs on separate hills: of those nearer than `apart` [m] the first.
std::vector<BestPair> separate(std::vector<BestPair> pairs, double apart) {
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<BestPair> best;
  for (const auto& pair : pairs) {
    const bool is_new = std::none_of(best.begin(), best.end(), [&](const auto& other) {
      return (other.position - pair.position).norm() < 0.99 * apart;
    });
    if (is_new && best.size() < kBestShown) best.push_back(pair);
  }
  return best;
}

}  // namespace

PairViews::PairViews(const Structure& structure, const Sites& surface, WantedModes wanted,
                     const Plan& plan)
    : structure_(structure),
      wanted_(std::move(wanted)),
      present_(0, structure.frequency_hz.size()),
      present_slopes_(0, std::ssize(wanted_.columns)),
      position_error_(plan.position_error),
      over_(plan.over) {
  actuators_.resize(0, structure.frequency_hz.size());
  if (structure.actuators.count() > 0) actuators_ = structure.actuators.shapes;
  for (std::size_t k = 0; k <= structure.ensemble.size(); ++k) {
    norms_.push_back(group_norms(wanted_part(surface.shapes, k), surface.area, wanted_.groups));
  }
  for (const auto& [s, a] :
       collocated_pairs(structure.sensors.lines, structure.actuators.lines, structure.size)) {
    if (!structure.sensors.keeps(s) || !structure.actuators.keeps(a)) continue;
    present_.conservativeResize(present_.rows() + 1, Eigen::NoChange);
    present_.bottomRows<1>() = structure.actuators.shapes.row(a);
    present_slopes_.conservativeResize(present_.rows(), std::ssize(wanted_.columns));
    present_slopes_.bottomRows<1>() = slopes_of(structure.actuators, a, surface)(wanted_.columns);
  }
}

Eigen::MatrixXd PairViews::wanted_part(const Eigen::MatrixXd& shapes, std::size_t member) const {
  if (member == 0) return shapes(Eigen::all, wanted_.columns);
  const Eigen::MatrixXd turn = structure_.ensemble[member - 1].turn(Eigen::all, wanted_.columns);
  return shapes * turn;
}

PairView PairViews::view(const Sites& sites, std::size_t member) const {
  PairView view;
  view.groups = wanted_.groups;
  view.shapes = wanted_part(sites.shapes, member);
  view.slopes = sites.slopes(Eigen::all, wanted_.columns);
  view.present = wanted_part(present_, member);
  view.present_slopes = present_slopes_;
  view.actuators = wanted_part(actuators_, member);
  view.largest = norms_[member].largest;
  view.rms = norms_[member].rms;
  view.sensor_noise = wanted_.sensor_noise;
  view.actuator_noise = wanted_.actuator_noise;
  view.position_error = position_error_;
  return view;
}

Views PairViews::at(const Sites& sites) const {
  return {norms_.size(), [this, &sites](std::size_t member) { return view(sites, member); }};
}

PairPlaces best_pairs(const PairViews& views, const Sites& surface, const Candidates& candidates,
                      const Plan& plan, const Sampler* sampler, const std::vector<Rule>& rules) {
  PairPlaces places;
  places.criterion = &criterion(plan.criterion);
  const auto all = criteria();
  places.chosen = static_cast<std::size_t>(std::ranges::find(all, places.criterion) - all.begin());
  places.maps = heat_maps(all, views.at(surface), views.over());
  const auto& sites = candidates.sites;
  const auto rows = all_rows(sites.count());
  const auto map = heat_map(*places.criterion, views.at(sites), views.over());
  const double apart = std::max(plan.spacing, 0.05 * diagonal_of(sites.position));
  const double last_step =
      std::min(Constants::last_step, Constants::last_step_part * diagonal_of(surface.position));
  std::optional<FaceFinder> faces;
  if (sampler != nullptr && !candidates.faces.empty()) {
    faces.emplace(sampler->body(), candidates.faces);
  }
  std::vector<BestPair> found;
  for (const auto row : best_sites(map.score, sites.position, rows, apart, 2 * kBestShown)) {
    auto site = part(sites, {row});
    if (sampler != nullptr && !candidates.is_grid) {
      site = refined(*sampler, site, worth_of(views, *places.criterion, rules),
                     0.5 * grain(surface), last_step, faces ? &*faces : nullptr);
    }
    const auto here = heat_map(*places.criterion, views.at(site), views.over());
    found.push_back({site.position.row(0).transpose(), here.score(0), here.limiting(0)});
  }
  places.best = separate(std::move(found), apart);  // two may have climbed the same hill
  if (plan.pairs < 2) return places;
  for (const auto& pair : chosen_pairs(*places.criterion, views.at(sites), views.over(),
                                       sites.position, rows, plan.spacing, plan.pairs)) {
    places.pairs.push_back({sites.position.row(pair.site).transpose(), pair.score, pair.limiting});
  }
  return places;
}

}  // namespace chladni::placement
