#include "placement/best_layouts.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "placement/optimum/present.h"
#include "placement/optimum/search_tree.h"

namespace chladni::placement {
namespace {

constexpr Eigen::Index kProvable = 400;  // most candidates for which the optimum is proven
constexpr int kNodes = 20000;            // of this search

// What stays, sensors first.
struct Present {
  Eigen::MatrixXd rows;  // p×r
  Eigen::Index sensors = 0;
};

Present rows_that_stay(const Structure& structure) {
  const auto sensors = rows_there(structure, structure.sensors, false);
  return {stacked(sensors, rows_there(structure, structure.actuators, false)), sensors.rows()};
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
                                           const Candidates& candidates, const Present& present,
                                           const WantedModes& wanted, double spacing,
                                           Eigen::Index count) {
  InterpolationProblem problem;
  problem.rows = candidates.sites.shapes;
  problem.noise = wanted.sensor_noise.cwiseQuotient(wanted.rms);
  problem.there = present.rows;
  problem.there_noise = problem.noise.transpose().replicate(present.rows.rows(), 1);
  const Eigen::RowVectorXd actuators = wanted.actuator_noise.cwiseQuotient(wanted.rms).transpose();
  problem.there_noise.bottomRows(present.rows.rows() - present.sensors).rowwise() = actuators;
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

// Whether the sites see each combination of the modes. One that they do not see has nothing but
// the little that keeps the determinant finite, and its share in score and bound means nothing.
bool tells_apart(const DeterminantProblem& problem, const std::vector<Eigen::Index>& sites) {
  const Eigen::MatrixXd rows = problem.rows(sites, Eigen::all);
  const Eigen::MatrixXd seen = problem.prior + rows.transpose() * rows;
  const Eigen::MatrixXd added = information(problem, sites) - seen;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(seen, Eigen::EigenvaluesOnly)
             .eigenvalues()(0) > added.diagonal().maxCoeff();
}

Optimum best_by_determinant(const DeterminantProblem& problem, unsigned seed) {
  Optimum optimum;
  optimum.by = "determinant";
  const Eigen::Index modes = problem.rows.cols();
  const bool provable = problem.rows.rows() <= kProvable;
  optimum.choice = best_determinant(
      problem, {.node_limit = provable ? kNodes : 0, .enough = 1e-9, .seed = seed});
  if (!tells_apart(problem, optimum.choice.sites)) {
    optimum.remark = fmt::format("no certificate: {} site{}{} cannot tell {} modes apart",
                                 problem.count, problem.count == 1 ? "" : "s",
                                 problem.prior.isZero() ? "" : " and what stays", modes);
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
    const auto rows = stacked(problem.there, problem.rows(sites, Eigen::all));
    const auto noise =
        stacked(problem.there_noise, problem.noise.transpose().replicate(problem.count, 1));
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
  const auto present = rows_that_stay(structure);
  std::vector<Optimum> optima;
  optima.push_back(best_by_determinant(
      determinant_problem(candidates, present.rows, wanted, plan.spacing, count), seed));
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
