#include "diagnosis/fit/fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "dense/algebra.h"
#include "dense/blas.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/quadratic.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double prior_of(const Structure& structure, const std::vector<Supposed>& causes) {
  double sum = 0.0;
  for (const auto& cause : causes) sum += log_prior(cause, structure);
  return sum;
}

// Negative ln of the posterior density.
double objective(const Problem& problem, const Fit& fit) {
  return 0.5 * fit.chi_square + 0.5 * fit.eta.squaredNorm() -
         prior_of(problem.structure, fit.causes);
}

void step(const Structure& structure, Fit& fit, const std::vector<Column>& columns,
          const VectorXd& by) {
  const auto before = fit.causes;
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const auto [low, high] = columns[n].parameter.ends();
    auto& x = fit.causes[columns[n].cause].x(columns[n].coordinate);
    x = std::clamp(x + by(static_cast<Index>(n)), low, high);
  }
  fit.eta += by.tail(fit.eta.size());
  for (std::size_t c = 0; c < before.size(); ++c) {
    keep_on_surface(structure, before[c], fit.causes[c]);
  }
}

// A fit at its current point, with its prediction and its residual.
struct Point {
  Fit fit;
  Solved now;
  VectorXd error;
};

Point point_of(const Problem& problem, Fit fit) {
  const State state = state_of(problem, fit.causes, fit.eta);
  Point point{std::move(fit), solved(state, Body(state, problem.observed.omega)), {}};
  point.error = residual(problem.observed, point.now.value);
  point.fit.chi_square = point.error.squaredNorm();
  point.fit.objective = objective(problem, point.fit);
  return point;
}

void add_prior(const Fit& fit, const std::vector<Column>& columns, Quadratic& quadratic) {
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const auto& [cause, coordinate, parameter] = columns[n];
    if (parameter.is_place()) continue;
    quadratic.add_prior(static_cast<Index>(n), fit.causes[cause].x(coordinate), parameter.centre,
                        parameter.width);
  }
  quadratic.gradient.tail(fit.eta.size()) += fit.eta;
  quadratic.curvature.diagonal().tail(fit.eta.size()).array() += 1.0;
}

Quadratic quadratic_at(const Problem& problem, const Point& here,
                       const std::vector<Column>& columns) {
  const MatrixXd jacobian = sensitivities(problem, here.fit.causes, here.fit.eta, here.now);
  MatrixXd gram = MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  dense::add_gram(jacobian, gram);
  Quadratic result{-jacobian.transpose() * here.error, gram.selfadjointView<Eigen::Lower>()};
  add_prior(here.fit, columns, result);
  return result;
}

// The point after a step; none if the step leads to an impossible state.
std::optional<Point> reached(const Problem& problem, Fit fit) {
  if (!std::isfinite(prior_of(problem.structure, fit.causes))) return std::nullopt;
  try {
    return point_of(problem, std::move(fit));
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

bool is_at_an_end(const Fit& fit, const Column& column, double forward) {
  const double x = fit.causes[column.cause].x(column.coordinate);
  const auto [low, high] = column.parameter.ends();
  return forward < 0.0 ? x <= low : x >= high;
}

// Indices of the coordinates that cannot follow the step: places at the rim of the surface, sizes
// at the end of what is plausible.
std::vector<Index> held_by_ends(const Structure& structure, const Fit& fit,
                                const std::vector<Column>& columns, const VectorXd& by) {
  std::vector<Index> held;
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const double forward = by(static_cast<Index>(n));
    if (forward == 0.0) continue;
    const auto [minus, plus] =
        sides_on_surface(structure, fit.causes[columns[n].cause], columns[n]);
    const bool at_rim = (forward < 0.0 ? minus : plus) == 0.0;
    if (at_rim || is_at_an_end(fit, columns[n], forward)) held.push_back(static_cast<Index>(n));
  }
  return held;
}

// Makes a step that lowers the objective, as long as possible; false: none was found.
bool descended(const Problem& problem, const std::vector<Column>& columns, double tolerance,
               const Quadratic& quadratic, Point& here, double& lambda) {
  bool taken = false;
  for (int attempt = 0; attempt < 8 && !taken && !here.fit.converged; ++attempt) {
    VectorXd by = quadratic.step(lambda);
    const auto held = held_by_ends(problem.structure, here.fit, columns, by);
    if (!held.empty()) by = quadratic.held(held).step(lambda);
    Fit next = here.fit;
    step(problem.structure, next, columns, by);
    if (auto trial = reached(problem, std::move(next))) {
      taken = trial->fit.objective < here.fit.objective;
      if (taken) here = std::move(*trial);
    }
    here.fit.converged = quadratic.promised(by) < tolerance;
    lambda = taken ? std::max(1e-9, 0.1 * lambda) : std::max(1e-4, 10.0 * lambda);
  }
  return taken;
}

// Fall of the objective that a full Newton step promises without the coordinates that are held.
double promised(const Quadratic& quadratic, const std::vector<Index>& held) {
  if (held.empty()) return quadratic.promised(quadratic.step(0.0));
  const Quadratic rest = quadratic.held(held);
  return rest.promised(rest.step(0.0));
}

// A place that the data do not determine is somewhere on the surface, and no wider: also where only
// some combination with another number is undetermined.
void bound_places(const Structure& structure, const std::vector<Column>& columns,
                  MatrixXd& curvature) {
  for (std::size_t n = 0; n < columns.size(); ++n) {
    if (!columns[n].parameter.is_place()) continue;
    curvature.diagonal()(static_cast<Index>(n)) +=
        std::pow(prior_width(structure, columns[n].parameter), -2);
  }
}

// Laplace's approximation at the mode. If two causes have the same effect, rounding of the data's
// curvature may be larger than the prior's curvature. The curvature then gets the size of the
// rounding.
void conclude(const MatrixXd& curvature, Fit& fit) {
  const VectorXd scale = curvature.diagonal().cwiseSqrt().cwiseInverse();
  MatrixXd scaled = scale.asDiagonal() * curvature * scale.asDiagonal();
  const double rounding =
      static_cast<double>(scale.size()) * std::numeric_limits<double>::epsilon();
  scaled.diagonal().array() += rounding;
  const Eigen::LLT<MatrixXd> factor(scaled);
  if (factor.info() != Eigen::Success) {
    throw NumericalFailure("a fit that nothing determines");
  }
  const double log_determinant =
      2.0 * (factor.matrixLLT().diagonal().array().log().sum() - scale.array().log().sum());
  const auto coordinates = static_cast<double>(fit.coordinate_count());
  fit.covariance = scale.asDiagonal() * dense::inverse_of(factor) * scale.asDiagonal();
  fit.log_evidence =
      -fit.objective + 0.5 * coordinates * std::log(2.0 * std::numbers::pi) - 0.5 * log_determinant;
}

// The integral ends where sizes are no longer plausible: beyond a fit near such an end, or at it,
// on the side on which the density falls.
void cut_at_ends(const VectorXd& gradient, const std::vector<Column>& columns,
                 const std::vector<Index>& held, Fit& fit) {
  for (Index n = 0; n < std::ssize(columns); ++n) {
    const auto& [cause, coordinate, parameter] = columns[at(n)];
    if (parameter.is_place()) continue;
    const auto [low, high] = parameter.ends();
    const double x = fit.causes[cause].x(coordinate);
    const bool is_held = std::ranges::find(held, n) != held.end();
    fit.log_evidence +=
        log_part_before_an_end({.distance = is_held ? 0.0 : std::min(x - low, high - x),
                                .slope = is_held ? std::abs(gradient(n)) : 0.0,
                                .deviation = std::sqrt(fit.covariance(n, n))});
  }
}

}  // namespace

double error_of(const Problem& problem, const Supposed& cause) {
  const double own = error_of(cause, problem.structure);
  return own > 0.0 ? std::hypot(own, problem.solver_error) : 0.0;
}

Index Fit::coordinate_count() const {
  Index count = 0;
  for (const auto& cause : causes) count += cause.x.size();
  return count;
}

double Fit::evidence_at_best() const {
  if (converged || !std::isfinite(promise)) return log_evidence;
  return log_evidence + std::clamp(promise, 0.0, kConstants.promise_at_most);
}

double Fit::excess(double numbers) const {
  return (chi_square - numbers + static_cast<double>(coordinate_count())) /
         std::sqrt(2.0 * numbers);
}

bool alike(const Structure& structure, const Fit& a, const Fit& b) {
  if (a.causes.size() != b.causes.size()) return false;
  return std::ranges::all_of(a.causes, [&](const Supposed& cause) {
    return std::ranges::any_of(b.causes, [&](const Supposed& other) {
      return same_choice(structure, cause, other, kConstants.same_place);
    });
  });
}

Fit with_deviations(Fit fit, std::size_t count) {
  const Index before = fit.eta.size();
  fit.eta.conservativeResize(static_cast<Index>(count));
  if (fit.eta.size() > before) fit.eta.tail(fit.eta.size() - before).setZero();
  return fit;
}

Fit fitted(const Problem& problem, const Fit& start, const FitLimits& limits) {
  const auto columns = columns_of(problem.structure, start.causes);
  Point here = point_of(problem, start);
  here.fit.less.clear();
  if (columns.empty() && here.fit.eta.size() == 0) {  // no coordinates
    here.fit.converged = true;
    here.fit.log_evidence = -here.fit.objective;
    return here.fit;
  }
  here.fit.converged = false;
  double lambda = 1e-3;
  Quadratic quadratic;
  bool is_here = false;  // the quadratic is that of the end point, or of a point close to it
  bool hopeless = false;
  int iteration = 0;
  for (; iteration < limits.iterations && !here.fit.converged && !hopeless; ++iteration) {
    const double before = here.fit.objective;
    quadratic = quadratic_at(problem, here, columns);
    if (limits.held) quadratic = quadratic.held({*limits.held});
    const bool moved = descended(problem, columns, limits.tolerance, quadratic, here, lambda);
    const double fall = before - here.fit.objective;
    is_here = fall < kConstants.small_fall;
    if (!moved) break;
    hopeless =
        iteration >= 2 && here.fit.objective - (limits.iterations - iteration) * fall > limits.bar;
  }
  here.fit.iterations = iteration;
  if (!is_here && !hopeless) quadratic = quadratic_at(problem, here, columns);
  const auto held = held_by_ends(problem.structure, here.fit, columns, quadratic.step(0.0));
  here.fit.promise = hopeless ? 0.0 : promised(quadratic, held);
  here.fit.converged = !hopeless && here.fit.promise < kConstants.nothing_more;
  bound_places(problem.structure, columns, quadratic.curvature);
  conclude(quadratic.curvature, here.fit);
  cut_at_ends(quadratic.gradient, columns, held, here.fit);
  return here.fit;
}

std::optional<Fit> possible_fit(const Problem& problem, const Fit& start, const FitLimits& limits) {
  try {
    return fitted(problem, start, limits);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

}  // namespace chladni::diagnosis
