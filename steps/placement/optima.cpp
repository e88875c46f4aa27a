// The best possible layouts, with a bound on their distance from the optimum.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "steps/placement/placing.h"

namespace chladni::steps {
namespace {

constexpr Eigen::Index kProvable = 400;  // most candidates for which the optimum is proven
constexpr int kNodes = 20000;            // of this search

// Rows of the channels that stay, for all modes.
Eigen::MatrixXd rows_there(const study::Study& study, const stage::Solution& solution,
                           const study::PlacementPlan& plan) {
  const auto& model = solution.model;
  const Eigen::MatrixXd sensors = stage::shapes_at(study.sensors, model.sensors, solution.modes);
  const Eigen::MatrixXd actuators =
      stage::shapes_at(study.actuators, model.actuators, solution.modes);
  Eigen::MatrixXd rows(0, solution.modes.mode_count());
  const auto add = [&](const std::vector<study::Channel>& channels, const Eigen::MatrixXd& shapes) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (!stays(plan, channels[i])) continue;
      rows.conservativeResize(rows.rows() + 1, Eigen::NoChange);
      rows.bottomRows<1>() = shapes.row(static_cast<Eigen::Index>(i));
    }
  };
  add(study.sensors, sensors);
  add(study.actuators, actuators);
  return rows;
}

// Number of sites: one per point of the study's channels, minus those that stay.
Eigen::Index sites_wanted(const study::Study& study, const stage::Solution& solution,
                          const study::PlacementPlan& plan, const WantedModes& wanted) {
  if (plan.sites > 0) return plan.sites;
  Eigen::Index points = static_cast<Eigen::Index>(study.sensors.size() + study.actuators.size());
  points -= static_cast<Eigen::Index>(pairs_of(study, solution).size());
  points -= static_cast<Eigen::Index>(plan.there.size());
  return points > 0 ? points : static_cast<Eigen::Index>(wanted.columns.size()) + 1;
}

placement::DeterminantProblem determinant_problem(const Candidates& candidates,
                                                  const Eigen::MatrixXd& there,
                                                  const WantedModes& wanted, double spacing,
                                                  Eigen::Index count) {
  const auto scaled = [&](const Eigen::MatrixXd& shapes) {
    const Eigen::MatrixXd part = shapes(Eigen::all, wanted.columns);
    return Eigen::MatrixXd(part * wanted.rms.cwiseInverse().asDiagonal());
  };
  placement::DeterminantProblem problem;
  problem.rows = scaled(candidates.sites.shapes);
  const Eigen::MatrixXd known = scaled(there);
  problem.prior = known.transpose() * known;
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

// The candidates to which the motion moves the chosen ones; empty if one has no candidate there.
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

Optimum best_by_determinant(const placement::DeterminantProblem& problem, unsigned seed) {
  Optimum optimum;
  optimum.by = "determinant";
  const Eigen::Index modes = problem.rows.cols();
  const bool provable = problem.rows.rows() <= kProvable;
  optimum.choice = placement::best_determinant(
      problem, {.node_limit = provable ? kNodes : 0, .enough = 1e-9, .seed = seed});
  if (problem.count < modes && problem.prior.isZero()) {
    optimum.remark =
        fmt::format("no certificate: {} sites cannot tell {} modes apart", problem.count, modes);
  } else {
    optimum.certificate = optimum.choice.certificate(modes);
  }
  optimum.sites = problem.position(optimum.choice.sites, Eigen::all);
  optimum.equivalent =
      equivalent(problem.position, optimum.choice.sites, optimum.choice.score,
                 [&](const auto& sites) { return placement::log_determinant(problem, sites); });
  return optimum;
}

Optimum best_by_interpolation(const Candidates& candidates, const Eigen::MatrixXd& there,
                              const stage::Solution& solution, const study::PlacementPlan& plan,
                              const Placed& placed, Eigen::Index count, unsigned seed) {
  const auto& wanted = placed.wanted;
  const auto& surface = placed.surface.sites;
  placement::InterpolationProblem problem;
  problem.rows = candidates.sites.shapes;
  problem.noise = wanted.sensor_noise.cwiseQuotient(wanted.rms);
  problem.there = there;
  problem.there_noise = problem.noise.transpose().replicate(there.rows(), 1);
  problem.prior = placement::shape_prior(surface.shapes, surface.area, solution.modes.frequency_hz,
                                         wanted.columns);
  problem.count = count;
  problem.position = candidates.sites.position;
  problem.spacing = plan.spacing;
  Optimum optimum;
  optimum.by = "interpolation_error";
  optimum.choice = placement::best_interpolation(problem, {.seed = seed});
  optimum.remark =
      "no certificate: no useful bound is known for this criterion; the best of "
      "several starts";
  optimum.sites = problem.position(optimum.choice.sites, Eigen::all);
  const auto score = [&](const std::vector<Eigen::Index>& sites) {
    Eigen::MatrixXd rows(there.rows() + count, there.cols());
    rows << there, problem.rows(sites, Eigen::all);
    const Eigen::MatrixXd noise = problem.noise.transpose().replicate(rows.rows(), 1);
    return -placement::expected_error(problem.prior, rows, noise).mean();
  };
  optimum.equivalent =
      equivalent(problem.position, optimum.choice.sites, optimum.choice.score, score);
  return optimum;
}

}  // namespace

void add_optima(const study::Study& study, const stage::Solution& solution,
                const study::PlacementPlan& plan, const Candidates& candidates, unsigned seed,
                Placed& placed) {
  const Eigen::Index count = sites_wanted(study, solution, plan, placed.wanted);
  require(count <= candidates.sites.count(),
          fmt::format("placement: {} sites are to be chosen, but {} are admissible; ask for fewer "
                      "(placement.choose.sites) or forbid less",
                      count, candidates.sites.count()));
  const Eigen::MatrixXd there = rows_there(study, solution, plan);
  placed.optima.push_back(best_by_determinant(
      determinant_problem(candidates, there, placed.wanted, plan.spacing, count), seed));
  placed.optima.push_back(
      best_by_interpolation(candidates, there, solution, plan, placed, count, seed));
  for (auto& optimum : placed.optima) {
    optimum.shapes = candidates.sites.shapes(optimum.choice.sites, Eigen::all);
  }
  if (plan.choose_by == "interpolation_error") std::swap(placed.optima[0], placed.optima[1]);
}

}  // namespace chladni::steps
