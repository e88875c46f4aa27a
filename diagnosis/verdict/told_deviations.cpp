#include "diagnosis/verdict/told_deviations.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/sensitivities.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Role = Parameter::Role;

bool is_placed(Role role) {
  return role == Role::place_u || role == Role::place_v || role == Role::offset;
}

// The fit moved by a step, and fitted again with coordinate n where the step leads; none where that
// is impossible.
std::optional<Fit> fitted_beside(const Problem& problem, const Fit& fit, const VectorXd& by,
                                 Index n) {
  Fit start = fit;
  Index first = 0;
  for (auto& cause : start.causes) {
    cause.x += by.segment(first, cause.x.size());
    first += cause.x.size();
    if (!std::isfinite(log_prior(cause, problem.structure))) return std::nullopt;
  }
  start.eta += by.tail(fit.eta.size());
  return possible_fit(
      problem, start,
      {.iterations = kConstants.steps_beside, .tolerance = kConstants.quick_tolerance, .held = n});
}

// Deviations of coordinate n to one side at which the objective has risen as a square has at
// kConstants.deviations_looked_at, over these; at most kConstants.longest_deviation. `one` is a
// step by one deviation.
double longer_by(const Problem& problem, const Fit& fit, Index n, const VectorXd& one) {
  const double first = kConstants.deviations_looked_at;
  const double wanted = 0.5 * first * first;
  double longer = 1.0;
  for (int look = 0; look < kConstants.deviation_looks; ++look) {
    const auto beside = fitted_beside(problem, fit, longer * first * one, n);
    const double rise = beside ? beside->objective - fit.objective : HUGE_VAL;
    if (rise >= wanted) break;
    longer *= std::sqrt(wanted / std::max(rise, 0.25 * wanted));
    if (longer >= kConstants.longest_deviation) return kConstants.longest_deviation;
  }
  return longer;
}

// The modes that the data hold: to the last line.
Index modes_seen(const Problem& problem) {
  const auto& omega = problem.observed.omega;
  const double high_hz = omega(omega.size() - 1) / (2.0 * std::numbers::pi);
  return (problem.structure.frequency_hz.array() <= high_hz).count();
}

// sqrt(Σ φ² / Σ (dφ/dx)²) over the flexible modes that the data hold [m]; 0 where none moves.
double length_of(const Problem& problem, const VectorXd& shapes, const VectorXd& slopes) {
  const Index rigid = problem.structure.rigid_count;
  const Index flexible = std::max<Index>(modes_seen(problem) - rigid, 0);
  const double slope = slopes.segment(rigid, flexible).norm();
  return slope > 0.0 ? shapes.segment(rigid, flexible).norm() / slope : 0.0;
}

// The motion of what a cause acts on: of its place, or of its channel. None: of neither.
std::optional<PointMotion> motion_of(const Structure& structure, const Supposed& cause) {
  if (const auto place = place_of(cause, structure)) return structure.surface.at(*place);
  const auto table = cause.effect->in_study.table;
  const bool is_sensor = table == InStudy::Table::sensors;
  if (!is_sensor && table != InStudy::Table::actuators) return std::nullopt;
  const auto& side = is_sensor ? structure.outputs : structure.inputs;
  if (cause.option >= side.count()) return std::nullopt;
  PointMotion motion;
  motion.shape = side.shapes.row(cause.option);
  motion.slope_u = side.slope_u.row(cause.option);
  motion.slope_v = side.slope_v.row(cause.option);
  return motion;
}

// Relative error of a resonance, over that of φ²: a quarter of sqrt(m φ²).
double share_of_resonance(const Problem& problem, const Cause& cause, const PointMotion& motion) {
  const auto mass = std::ranges::find(cause.parameters, "mass", &CauseParameter::name);
  if (mass == cause.parameters.end() || modes_seen(problem) == 0) return 0.0;
  const double most = motion.shape.head(modes_seen(problem)).cwiseAbs().maxCoeff();
  return 0.25 * std::sqrt(std::abs(mass->value)) * most;
}

// What an error of the shapes by mesh or solver adds to a number of a cause that acts by them.
double by_solver(const Problem& problem, const Cause& cause, const CauseParameter& number,
                 const std::optional<PointMotion>& motion) {
  const double error = problem.solver_error;
  switch (number.role) {
    case Role::strength:
    case Role::extent:
    case Role::shape:
      return error * std::abs(number.value);
    case Role::frequency:
      return motion ? error * share_of_resonance(problem, cause, *motion) * number.value : 0.0;
    case Role::place_u:
    case Role::place_v:
    case Role::offset:
      break;
  }
  if (!motion) return 0.0;
  const auto& slopes = number.name == "v" ? motion->slope_v : motion->slope_u;
  return 0.5 * error * length_of(problem, motion->shape, slopes);
}

}  // namespace

VectorXd longer_deviations(const Problem& problem, const Fit& fit) {
  VectorXd longer = VectorXd::Ones(fit.coordinate_count());
  const auto columns = columns_of(problem.structure, fit.causes);
  for (Index n = 0; n < longer.size(); ++n) {
    const double deviation = std::sqrt(fit.covariance(n, n));
    if (!is_placed(columns[at(n)].parameter.role) || !(deviation > 0.0)) continue;
    const VectorXd one = fit.covariance.col(n) / deviation;
    longer(n) = std::max({1.0, longer_by(problem, fit, n, one), longer_by(problem, fit, n, -one)});
  }
  return longer;
}

// The errors of the causes cost `lost` in ln likelihood, so their squared length in whitened data
// is 2 lost. It is spread over the independent directions of the data (modes times channels), so
// any one number gets a small part of it. The error of mesh or solver acts on all sizes of a cause
// together.
void widen_deviations(const Problem& problem, const Fit& fit, Explanation& explanation) {
  const double lost = lost_by(explanation.error_excess, problem.observed.number_count());
  const double wider = std::sqrt(1.0 + kConstants.error_per_number * lost);
  const VectorXd longer = longer_deviations(problem, fit);
  Index n = 0;
  for (std::size_t c = 0; c < fit.causes.size(); ++c) {
    Cause& cause = explanation.causes[c];
    const bool by_shapes = effect(cause.effect).error > 0.0;
    const auto motion = by_shapes ? motion_of(problem.structure, fit.causes[c]) : std::nullopt;
    for (auto& number : cause.parameters) {
      const double solver = by_shapes ? by_solver(problem, cause, number, motion) : 0.0;
      number.std = std::hypot(number.std * wider * longer(n++), solver);
    }
  }
}

}  // namespace chladni::diagnosis
