#include "diagnosis/fit/fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "dense/algebra.h"
#include "dense/blas.h"
#include "diagnosis/attached/loaded_damping.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/search/quadratic.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The cause and the coordinate of a column.
struct Column {
  std::size_t cause = 0;
  Index coordinate = 0;
  Parameter parameter;
};

std::vector<Column> columns_of(const Structure& structure, const std::vector<Supposed>& causes) {
  std::vector<Column> columns;
  for (std::size_t c = 0; c < causes.size(); ++c) {
    Index i = 0;
    for (const auto& parameter : causes[c].effect->parameters(structure)) {
      columns.push_back({c, i++, parameter});
    }
  }
  return columns;
}

// Factors of the steps to both sides that stay on the surface: 1 and 1, or one of them 0 at its
// rim.
std::pair<double, double> sides(const Structure& structure, const Supposed& cause,
                                const Column& column) {
  if (!column.parameter.is_place()) return {1.0, 1.0};
  const auto is_there = [&](double by) {
    Supposed moved = cause;
    moved.x(column.coordinate) += by;
    const auto place = place_of(moved, structure);
    return !place || structure.surface.at(*place).has_value();
  };
  const bool minus = is_there(-column.parameter.step);
  const bool plus = is_there(column.parameter.step);
  if (minus == plus) return {1.0, 1.0};
  return {minus ? 1.0 : 0.0, plus ? 1.0 : 0.0};
}

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
    const auto [minus, plus] = sides(structure, fit.causes[columns[n].cause], columns[n]);
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

// States about a fit, in which one coordinate of a cause or one deviation is moved.
class About {
 public:
  About(const Problem& problem, const std::vector<Supposed>& causes, const VectorXd& eta)
      : problem_(problem), causes_(causes), eta_(eta) {
    for (const auto& cause : causes) changes_.push_back(change_of(cause, problem.structure));
  }

  [[nodiscard]] State here() const { return changed(deviating_by(eta_)); }

  [[nodiscard]] State with_deviation(Index i, double by) const {
    return changed(deviating_by(eta_ + by * VectorXd::Unit(eta_.size(), i)));
  }

  [[nodiscard]] State with_coordinate(const Column& column, double by) const {
    State state = deviating_by(eta_);
    std::vector<Supposed> moved = causes_;
    moved[column.cause].x(column.coordinate) += by;
    for (std::size_t c = 0; c < changes_.size(); ++c) {
      if (c != column.cause) {
        changes_[c](state);
      } else {
        moved[c].effect->apply(state, problem_.structure, moved[c].option, moved[c].x);
      }
    }
    if (state.loaded_damping != 0.0) take_in(loaded_damping(problem_.structure, moved), state);
    return state;
  }

 private:
  [[nodiscard]] State deviating_by(const VectorXd& eta) const {
    return deviating(problem_.structure, problem_.deviations, eta);
  }
  [[nodiscard]] State changed(State state) const {
    for (const auto& change : changes_) change(state);
    if (state.loaded_damping == 0.0 || changes_.empty()) return state;
    std::call_once(once_, [&] { loaded_ = loaded_damping(problem_.structure, causes_); });
    take_in(loaded_, state);
    return state;
  }
  static void take_in(const LoadedDamping& loaded, State& state) {
    const MatrixXd gained = loaded.gained(state.relative_damping);
    if (gained.size() > 0) state.damping += state.loaded_damping * gained;
  }

  const Problem& problem_;
  const std::vector<Supposed>& causes_;
  const VectorXd& eta_;
  std::vector<std::function<void(State&)>> changes_;
  mutable std::once_flag once_;
  mutable LoadedDamping loaded_;  // for the causes, made on first use
};

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

State state_of(const Problem& problem, const std::vector<Supposed>& causes, const VectorXd& eta) {
  return About(problem, causes, eta).here();
}

MatrixXd sensitivities(const Problem& problem, const std::vector<Supposed>& causes,
                       const VectorXd& eta, const Solved& now) {
  const auto columns = columns_of(problem.structure, causes);
  const auto count = static_cast<Index>(columns.size());
  const About about(problem, causes, eta);
  const State here = about.here();
  MatrixXd jacobian(2 * problem.observed.value.size(), count + eta.size());
  const auto sloping = [&](const State& minus, const State& plus, double step) {
    return weighted(problem.observed, slope(here, now, minus, plus, step));
  };
  const auto of_cause = [&](const Column& column) {
    const double h = column.parameter.step;
    const auto [minus, plus] = sides(problem.structure, causes[column.cause], column);
    return sloping(about.with_coordinate(column, -minus * h),
                   about.with_coordinate(column, plus * h), (minus + plus) * h);
  };
  const auto of_deviation = [&](Index i) {
    constexpr double kStep = 1e-3;
    return sloping(about.with_deviation(i, -kStep), about.with_deviation(i, kStep), 2.0 * kStep);
  };
  const dense::OneBlasThread one_thread;
  parallel_tasks(at(jacobian.cols()), [&](std::size_t n) {
    const auto i = static_cast<Index>(n);
    jacobian.col(i) = i < count ? of_cause(columns[n]) : of_deviation(i - count);
  });
  return jacobian;
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

}  // namespace chladni::diagnosis
