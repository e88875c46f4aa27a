#include "placement/best_layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "placement/constants.h"

namespace chladni::placement {
namespace {

constexpr Eigen::Index kProvable = 400;  // most candidates for which the optimum is proven
constexpr int kNodes = 20000;            // of this search

// Rows of the channels that stay, or of all, for all modes.
Eigen::MatrixXd rows_there(const Structure& structure, const Channels& channels, bool all) {
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < channels.count(); ++i) {
    if (all || channels.keeps(i)) chosen.push_back(i);
  }
  if (chosen.empty()) return Eigen::MatrixXd(0, structure.frequency_hz.size());
  return channels.shapes(chosen, Eigen::all);
}

Eigen::MatrixXd stacked(const Eigen::MatrixXd& above, const Eigen::MatrixXd& below) {
  if (above.rows() == 0) return below;
  if (below.rows() == 0) return above;
  Eigen::MatrixXd both(above.rows() + below.rows(), above.cols());
  both << above, below;
  return both;
}

Eigen::MatrixXd rows_that_stay(const Structure& structure) {
  return stacked(rows_there(structure, structure.sensors, false),
                 rows_there(structure, structure.actuators, false));
}

Eigen::Index site_count(const Plan& plan, const WantedModes& wanted) {
  return plan.sites > 0 ? plan.sites : std::ssize(wanted.columns) + 1;
}

DeviceCounts devices_of(const Plan& plan, const WantedModes& wanted) {
  if (plan.devices.all() > 0) return plan.devices;
  return {.sensors = static_cast<int>(site_count(plan, wanted))};
}

// What the layout of an observer has beside what is chosen.
Eigen::MatrixXd sensors_there(const Structure& structure, const DeviceCounts& counts) {
  return rows_there(structure, structure.sensors, counts.sensors == 0 && counts.pairs == 0);
}
Eigen::MatrixXd actuators_there(const Structure& structure, const DeviceCounts& counts) {
  return rows_there(structure, structure.actuators, counts.only_sensors());
}

DeterminantProblem determinant_problem(const Candidates& candidates, const Eigen::MatrixXd& present,
                                       const WantedModes& wanted, double spacing,
                                       Eigen::Index count) {
  const auto scaled = [&](const Eigen::MatrixXd& shapes) {
    const Eigen::MatrixXd part = shapes(Eigen::all, wanted.columns);
    return Eigen::MatrixXd(part * wanted.rms.cwiseInverse().asDiagonal());
  };
  DeterminantProblem problem;
  problem.rows = scaled(candidates.sites.shapes);
  const Eigen::MatrixXd known = scaled(present);
  problem.prior = known.transpose() * known;
  problem.count = count;
  problem.position = candidates.sites.position;
  problem.spacing = spacing;
  return problem;
}

InterpolationProblem interpolation_problem(const Structure& structure, const Sites& surface,
                                           const Candidates& candidates,
                                           const Eigen::MatrixXd& present,
                                           const WantedModes& wanted, double spacing,
                                           Eigen::Index count) {
  InterpolationProblem problem;
  problem.rows = candidates.sites.shapes;
  problem.noise = wanted.sensor_noise.cwiseQuotient(wanted.rms);
  problem.there = present;
  problem.there_noise = problem.noise.transpose().replicate(present.rows(), 1);
  problem.prior = shape_prior(surface.shapes, surface.area, structure.frequency_hz, wanted.columns);
  problem.count = count;
  problem.position = candidates.sites.position;
  problem.spacing = spacing;
  return problem;
}

// The seven symmetries of a square except identity, about the middle of the candidates, seen from
// above.
std::vector<Eigen::Matrix2d> square_symmetries() {
  std::vector<Eigen::Matrix2d> motions;
  Eigen::Matrix2d quarter;
  quarter << 0, -1, 1, 0;
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d mirror = Eigen::Vector2d(-1.0, 1.0).asDiagonal();
  for (int k = 0; k < 4; ++k, turn = (quarter * turn).eval()) {
    if (k > 0) motions.push_back(turn);
    motions.emplace_back(turn * mirror);
  }
  return motions;
}

// The candidates to which the motion moves the chosen ones; empty if a site has no candidate there.
std::vector<Eigen::Index> moved(const Points& position, const std::vector<Eigen::Index>& sites,
                                const Eigen::Matrix2d& motion) {
  const Eigen::RowVector3d low = position.colwise().minCoeff();
  const Eigen::RowVector3d high = position.colwise().maxCoeff();
  const Eigen::Vector2d centre = 0.5 * (low + high).head<2>().transpose();
  const double near = 1e-4 * (high - low).norm();
  std::vector<Eigen::Index> result;
  for (const auto site : sites) {
    Eigen::RowVector3d at = position.row(site);
    at.head<2>() = (centre + motion * (at.head<2>().transpose() - centre)).transpose();
    Eigen::Index nearest = 0;
    if ((position.rowwise() - at).rowwise().norm().minCoeff(&nearest) > near) return {};
    result.push_back(nearest);
  }
  std::sort(result.begin(), result.end());
  return result;
}

template <typename Score>
std::vector<Points> equivalent(const Points& position, const std::vector<Eigen::Index>& sites,
                               double best, const Score& score) {
  std::vector<std::vector<Eigen::Index>> known{sites};
  std::vector<Points> found;
  for (const auto& motion : square_symmetries()) {
    const auto other = moved(position, sites, motion);
    if (other.empty() || std::find(known.begin(), known.end(), other) != known.end()) continue;
    known.push_back(other);
    if (score(other) < best - 1e-3 * std::max(1e-3, std::abs(best))) continue;
    found.push_back(position(other, Eigen::all));
  }
  return found;
}

Optimum best_by_determinant(const DeterminantProblem& problem, unsigned seed) {
  Optimum optimum;
  optimum.by = "determinant";
  const Eigen::Index modes = problem.rows.cols();
  const bool provable = problem.rows.rows() <= kProvable;
  optimum.choice = best_determinant(
      problem, {.node_limit = provable ? kNodes : 0, .enough = 1e-9, .seed = seed});
  if (problem.count < modes && problem.prior.isZero()) {
    optimum.remark =
        fmt::format("no certificate: {} sites cannot tell {} modes apart", problem.count, modes);
  } else {
    optimum.certificate = optimum.choice.certificate(modes);
  }
  optimum.equivalent =
      equivalent(problem.position, optimum.choice.sites, optimum.choice.score,
                 [&](const auto& sites) { return log_determinant(problem, sites); });
  return optimum;
}

Optimum best_by_interpolation(const InterpolationProblem& problem, unsigned seed) {
  Optimum optimum;
  optimum.by = "interpolation_error";
  optimum.choice = best_interpolation(problem, {.seed = seed});
  optimum.remark =
      "no certificate: no useful bound is known for this criterion; the best of "
      "several starts";
  const auto score = [&](const std::vector<Eigen::Index>& sites) {
    const auto& present = problem.there;
    Eigen::MatrixXd rows(present.rows() + problem.count, present.cols());
    rows << present, problem.rows(sites, Eigen::all);
    const Eigen::MatrixXd noise = problem.noise.transpose().replicate(rows.rows(), 1);
    return -expected_error(problem.prior, rows, noise).mean();
  };
  optimum.equivalent =
      equivalent(problem.position, optimum.choice.sites, optimum.choice.score, score);
  return optimum;
}

Optimum best_by_observer(const Structure& structure, const Candidates& candidates,
                         const WantedModes& wanted, const Plan& plan, unsigned seed) {
  const auto counts = devices_of(plan, wanted);
  const ObserverProblem problem{.task = *plan.observer,
                                .rows = candidates.sites.shapes,
                                .sensors = sensors_there(structure, counts),
                                .actuators = actuators_there(structure, counts),
                                .counts = counts,
                                .position = candidates.sites.position,
                                .spacing = plan.spacing};
  const auto choice = best_observer(problem, {.seed = seed});
  Optimum optimum;
  optimum.by = counts.only_sensors() ? "observer_error" : "loop_cost";
  for (const auto& device : choice.devices) {
    optimum.choice.sites.push_back(device.site);
    optimum.kinds.push_back(device.kind);
  }
  optimum.choice.score = -cost_of(problem, choice.value);
  optimum.observer = choice.value;
  optimum.remark =
      "no certificate: the steady variance is neither submodular nor convex in the devices, so "
      "that "
      "no bound is known; ";
  optimum.remark += choice.swap_optimal
                        ? "no exchange of one device gains"
                        : fmt::format(
                              "of {} candidates a part was tried, then the neighbours of the "
                              "best",
                              candidates.sites.count());
  return optimum;
}

}  // namespace

Eigen::MatrixXd Optimum::all_but(DeviceKind other) const {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < shapes.rows(); ++i) {
    const auto kind = kinds.empty() ? DeviceKind::sensor : kinds[static_cast<std::size_t>(i)];
    if (kind != other) rows.push_back(i);
  }
  if (rows.empty()) return Eigen::MatrixXd(0, shapes.cols());
  return shapes(rows, Eigen::all);
}

LayoutScorer::LayoutScorer(const Structure& structure, const Sites& surface, WantedModes wanted,
                           const Plan& plan)
    : structure_(structure),
      surface_(surface),
      wanted_(std::move(wanted)),
      frequency_tolerance_(plan.frequency_tolerance),
      devices_(devices_of(plan, wanted_)) {
  if (plan.observer) observer_ = std::make_shared<ObserverModel>(*plan.observer);
  const auto& columns = wanted_.columns;
  view_.groups = wanted_.groups;
  view_.frequency_hz = structure.frequency_hz(columns);
  view_.damping_ratio = structure.damping_ratio(columns);
  view_.rms = wanted_.rms;
  view_.sensor_noise = wanted_.sensor_noise;
  view_.actuator_noise = wanted_.actuator_noise;
  view_.prior = shape_prior(surface.shapes, surface.area, structure.frequency_hz, columns);
  view_.surface_all = surface.shapes;
  view_.interest_all = structure.interest;
  view_.interest_all.conservativeResize(structure.interest.rows(), structure.frequency_hz.size());
  view_.interest = view_.interest_all(Eigen::all, columns);
}

LayoutScore LayoutScorer::of_channels(const std::vector<std::size_t>& sensors,
                                      const std::vector<std::size_t>& actuators) const {
  const auto chosen = [](const Channels& channels, const std::vector<std::size_t>& rows) {
    for (const auto row : rows) {
      require(static_cast<Eigen::Index>(row) < channels.count(),
              fmt::format("placement: channel {} of a layout does not exist; there are {}", row,
                          channels.count()));
    }
    return Lines{channels.lines.position(rows, Eigen::all),
                 channels.lines.direction(rows, Eigen::all)};
  };
  auto view = view_;
  view.pairs = collocated_pairs(chosen(structure_.sensors, sensors),
                                chosen(structure_.actuators, actuators), structure_.size);
  const auto modes = structure_.frequency_hz.size();
  view.sensors_all.resize(0, modes);
  if (!sensors.empty()) view.sensors_all = structure_.sensors.shapes(sensors, Eigen::all);
  view.actuators_all.resize(0, modes);
  if (!actuators.empty()) view.actuators_all = structure_.actuators.shapes(actuators, Eigen::all);
  const Eigen::MatrixXd watched = view.sensors_all;
  const Eigen::MatrixXd disturbing =
      actuators.empty() ? rows_there(structure_, structure_.actuators, true) : view.actuators_all;
  return scored(std::move(view), watched, disturbing);
}

LayoutScore LayoutScorer::of_sensors(const Eigen::MatrixXd& shapes) const {
  auto view = view_;
  view.sensors_all = shapes;
  view.actuators_all.resize(0, shapes.cols());
  return scored(std::move(view), stacked(rows_there(structure_, structure_.sensors, false), shapes),
                rows_there(structure_, structure_.actuators, true));
}

LayoutScore LayoutScorer::of_devices(const Eigen::MatrixXd& sensors,
                                     const Eigen::MatrixXd& actuators) const {
  auto view = view_;
  view.sensors_all = sensors;
  view.actuators_all = actuators;
  return scored(std::move(view), stacked(sensors_there(structure_, devices_), sensors),
                stacked(actuators_there(structure_, devices_), actuators));
}

// `watched` and `disturbing`: sensors and actuators of an observer.
LayoutScore LayoutScorer::scored(LayoutView view, const Eigen::MatrixXd& watched,
                                 const Eigen::MatrixXd& disturbing) const {
  view.sensors = view.sensors_all(Eigen::all, wanted_.columns);
  view.actuators = view.actuators_all(Eigen::all, wanted_.columns);
  LayoutScore layout;
  layout.pairs = static_cast<int>(view.pairs.size());
  if (observer_ && watched.rows() > 0) {
    layout.observer = view.observer = observer_->value(watched, disturbing);
    layout.motion_deviation = estimate_deviation(layout.observer->coordinates, surface_.shapes);
  }
  const auto criteria = layout_criteria();
  layout.scores.resize(static_cast<Eigen::Index>(criteria.size()));
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    layout.scores(static_cast<Eigen::Index>(c)) = criteria[c]->value(view);
  }
  layout.blind = blind_modes(view);
  const auto points = samples(view);
  if (points.rows.rows() > 0) {
    layout.deviation = expected_deviation(view.prior, points.rows, points.noise, view.surface_all)
                           .cwiseAbs2()
                           .rowwise()
                           .mean()
                           .cwiseSqrt();
  }
  return layout;
}

// Modes of the whole structure, counted from 1, that the points cannot see.
std::vector<int> LayoutScorer::blind_modes(LayoutView view) const {
  const Eigen::Index rigid = structure_.rigid_count;
  const Eigen::Index flexible = structure_.frequency_hz.size() - rigid;
  view.groups = modal::groups(structure_.frequency_hz.tail(flexible), frequency_tolerance_);
  const auto norms = group_norms(surface_.shapes.rightCols(flexible), surface_.area, view.groups);
  view.rms.resize(flexible);
  for (std::size_t g = 0; g < view.groups.size(); ++g) {
    view.rms.segment(view.groups[g].first, view.groups[g].size)
        .setConstant(norms.rms(static_cast<Eigen::Index>(g)));
  }
  view.sensors = view.sensors_all.rightCols(flexible).eval();
  view.actuators = view.actuators_all.rightCols(flexible).eval();
  const Eigen::VectorXd seen = sight(view);
  std::vector<int> blind;
  const double still = 1e-3 / std::sqrt(structure_.mass_kg);
  for (std::size_t g = 0; g < view.groups.size(); ++g) {
    const auto [first, size] = view.groups[g];
    // A mode that hardly moves the surface in this direction is not counted.
    if (seen(static_cast<Eigen::Index>(g)) >= Constants::blind || view.rms(first) < still) continue;
    for (Eigen::Index i = 0; i < size; ++i) {
      blind.push_back(static_cast<int>(rigid + first + i + 1));
    }
  }
  return blind;
}

std::vector<Optimum> best_layouts(const Structure& structure, const Sites& surface,
                                  const Candidates& candidates, const WantedModes& wanted,
                                  const Plan& plan, unsigned seed) {
  const Eigen::Index count = site_count(plan, wanted);
  const auto& sites = candidates.sites;
  require_fit(structure, surface);
  require(count <= sites.count(),
          fmt::format("placement: {} sites are to be chosen, but {} are admissible; ask for fewer "
                      "(placement.choose.sites) or forbid less",
                      count, sites.count()));
  const Eigen::MatrixXd present = rows_that_stay(structure);
  std::vector<Optimum> optima;
  optima.push_back(best_by_determinant(
      determinant_problem(candidates, present, wanted, plan.spacing, count), seed));
  optima.push_back(best_by_interpolation(
      interpolation_problem(structure, surface, candidates, present, wanted, plan.spacing, count),
      seed));
  if (plan.observer) {
    optima.push_back(best_by_observer(structure, candidates, wanted, plan, seed));
  }
  for (auto& optimum : optima) {
    optimum.sites = sites.position(optimum.choice.sites, Eigen::all);
    optimum.shapes = sites.shapes(optimum.choice.sites, Eigen::all);
  }
  if (plan.by_interpolation) std::swap(optima[0], optima[1]);
  if (plan.by_observer && plan.observer) std::ranges::rotate(optima, optima.end() - 1);
  return optima;
}

}  // namespace chladni::placement
