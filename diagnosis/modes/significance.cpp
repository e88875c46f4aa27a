#include "diagnosis/modes/significance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// Deviations of the coordinates of a cause, whose first one is `first` of the fit.
Eigen::VectorXd deviations(const ModesProblem& problem, const ModesFit& fit, const Supposed& cause,
                           Index first, SizeDeviation by) {
  using Role = Parameter::Role;
  std::vector<Index> held;
  const auto parameters = cause.effect->parameters(problem.structure());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto role = parameters[i].role;
    const bool is_held = role == Role::extent || role == Role::shape ||
                         (by == SizeDeviation::in_place && parameters[i].is_place());
    if (is_held) held.push_back(first + static_cast<Index>(i));
  }
  Eigen::VectorXd variance = fit.covariance.diagonal().segment(first, cause.x.size());
  if (!held.empty()) {
    const Eigen::MatrixXd beside = fit.covariance(held, Eigen::seqN(first, cause.x.size()));
    const Eigen::LDLT<Eigen::MatrixXd> of_held(Eigen::MatrixXd(fit.covariance(held, held)));
    const Eigen::MatrixXd explained = beside.transpose() * of_held.solve(beside);
    variance = (variance - explained.diagonal()).cwiseMax(0.0);
  }
  return variance.cwiseSqrt();
}

// The deviation that a sound structure may have of the same kind: the tolerance, or its level.
double usual_size(const ModesProblem& problem, const ModesFit& fit, const Effect& effect) {
  if (effect.tolerance == nullptr) return 0.0;
  const double stated = problem.tolerances().*effect.tolerance;
  const auto level = [&](ErrorClass of) { return fit.levels(static_cast<int>(of)); };
  if (effect.tolerance == &Tolerances::gain) return std::max(stated, level(ErrorClass::gain));
  if (effect.tolerance == &Tolerances::position) return std::max(stated, level(ErrorClass::place));
  return stated;
}

bool is_strength(const Parameter& parameter) {
  using Role = Parameter::Role;
  return parameter.role == Role::strength || parameter.role == Role::offset;
}

}  // namespace

bool is_significant(const ModesProblem& problem, const ModesFit& fit, std::size_t which,
                    SizeDeviation by) {
  const auto& cause = fit.causes[which];
  Index first = 0;
  for (std::size_t c = 0; c < which; ++c) first += fit.causes[c].x.size();
  const auto parameters = cause.effect->parameters(problem.structure());
  const bool has_strength = std::ranges::any_of(parameters, is_strength);
  const auto is_size = [&](const Parameter& parameter) {
    const bool is_frequency = parameter.role == Parameter::Role::frequency;
    return is_strength(parameter) ||
           (is_frequency && (!has_strength || by == SizeDeviation::anywhere));
  };
  if (std::ranges::none_of(parameters, is_size)) return true;
  const auto deviation = deviations(problem, fit, cause, first, by);
  const double usual = usual_size(problem, fit, *cause.effect);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!is_size(parameters[i])) continue;
    const auto at = static_cast<Index>(i);
    const bool is_clear =
        parameters[i].is_about_zero()
            ? std::abs(cause.x(at)) > kConstants.significant * std::max(deviation(at), usual)
            : deviation(at) < kConstants.determined;
    if (is_clear) return true;
  }
  return false;
}

bool have_clear_sizes(const ModesProblem& problem, const ModesFit& fit) {
  for (std::size_t c = 0; c < fit.causes.size(); ++c) {
    if (!is_significant(problem, fit, c, SizeDeviation::anywhere)) return false;
  }
  return true;
}

}  // namespace chladni::diagnosis
