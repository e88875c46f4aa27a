#include "diagnosis/fit.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/parallel.h"
#include "priors/dense.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// Which cause and which of its coordinates a column is.
struct Column {
  std::size_t cause = 0;
  Index coordinate = 0;
  Parameter parameter;
};

std::vector<Column> columns_of(const Structure& structure, const std::vector<Supposed>& causes) {
  std::vector<Column> all;
  for (std::size_t c = 0; c < causes.size(); ++c) {
    Index i = 0;
    for (const auto& parameter : causes[c].effect->parameters(structure)) {
      all.push_back({c, i++, parameter});
    }
  }
  return all;
}

double prior_of(const Structure& structure, const std::vector<Supposed>& causes) {
  double sum = 0.0;
  for (const auto& cause : causes) sum += log_prior(cause, structure);
  return sum;
}

// Minus the logarithm of the posterior density.
double objective(const Problem& problem, const Fit& fit) {
  return 0.5 * fit.chi_square + 0.5 * fit.eta.squaredNorm() -
         prior_of(problem.structure, fit.causes);
}

void step(const Structure& structure, Fit& fit, const std::vector<Column>& columns,
          const VectorXd& by) {
  const auto before = fit.causes;
  for (std::size_t n = 0; n < columns.size(); ++n) {
    fit.causes[columns[n].cause].x(columns[n].coordinate) += by(static_cast<Index>(n));
  }
  fit.eta += by.tail(fit.eta.size());
  for (std::size_t c = 0; c < before.size(); ++c) {
    keep_on_surface(structure, before[c], fit.causes[c]);
  }
}

// Slope and curvature of −ln prior at the fit.
void add_prior(const Fit& fit, const std::vector<Column>& columns, VectorXd& gradient,
               MatrixXd& curvature) {
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const auto& parameter = columns[n].parameter;
    if (parameter.is_place()) continue;
    const auto i = static_cast<Index>(n);
    const double precision = 1.0 / (parameter.width * parameter.width);
    const double x = fit.causes[columns[n].cause].x(columns[n].coordinate);
    gradient(i) += precision * (x - parameter.centre);
    curvature(i, i) += precision;
  }
  gradient.tail(fit.eta.size()) += fit.eta;
  curvature.diagonal().tail(fit.eta.size()).array() += 1.0;
}

// JᵀJ and Jᵀr.
struct Normal {
  MatrixXd gram;
  VectorXd toward;
};
Normal normal_of(const MatrixXd& jacobian, const VectorXd& residual) {
  Normal normal{MatrixXd::Zero(jacobian.cols(), jacobian.cols()), jacobian.transpose() * residual};
  priors::dense::add_gram(jacobian, normal.gram);
  normal.gram = MatrixXd(normal.gram.selfadjointView<Eigen::Lower>());
  return normal;
}

Solved solved_at(const Problem& problem, const Fit& fit) {
  const State state = state_of(problem, fit.causes, fit.eta);
  return solved(state, Body(state, problem.observed.omega));
}

// Laplace's approximation at the mode.
void conclude(const Problem& problem, const MatrixXd& curvature, Fit& fit) {
  const Eigen::LLT<MatrixXd> factor(curvature);
  if (factor.info() != Eigen::Success) throw NumericalFailure("a fit that nothing determines");
  const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  const auto coordinates = static_cast<double>(fit.coordinate_count());
  fit.covariance = factor.solve(MatrixXd::Identity(curvature.rows(), curvature.cols()));
  fit.log_evidence = -objective(problem, fit) +
                     0.5 * coordinates * std::log(2.0 * std::numbers::pi) - 0.5 * log_determinant;
}

}  // namespace

Index Fit::coordinate_count() const {
  Index count = 0;
  for (const auto& cause : causes) count += cause.x.size();
  return count;
}

double Fit::excess(double numbers) const {
  return (chi_square - numbers + static_cast<double>(coordinate_count())) /
         std::sqrt(2.0 * numbers);
}

State state_of(const Problem& problem, const std::vector<Supposed>& causes, const VectorXd& eta) {
  State state = state_of(problem.structure);
  for (Index i = 0; i < eta.size(); ++i) {
    if (eta(i) != 0.0) problem.deviations[at(i)].apply(state, eta(i));
  }
  for (const auto& cause : causes) {
    cause.effect->apply(state, problem.structure, cause.option, cause.x);
  }
  return state;
}

MatrixXd sensitivities(const Problem& problem, const std::vector<Supposed>& causes,
                       const VectorXd& eta, const Solved& now) {
  const auto columns = columns_of(problem.structure, causes);
  const auto count = static_cast<Index>(columns.size());
  const State here = state_of(problem, causes, eta);
  MatrixXd jacobian(2 * problem.observed.value.size(), count + eta.size());
  const priors::dense::OneThread one;
  parallel_ranges(at(jacobian.cols()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const auto i = static_cast<Index>(n);
      const auto moved = [&](double by) {
        if (i >= count)
          return state_of(problem, causes, eta + by * VectorXd::Unit(eta.size(), i - count));
        auto other = causes;
        other[columns[n].cause].x(columns[n].coordinate) += by;
        return state_of(problem, other, eta);
      };
      const double h = i < count ? columns[n].parameter.step : 1e-3;
      jacobian.col(i) = weighted(problem.observed, slope(here, now, moved(-h), moved(h), 2.0 * h));
    }
  });
  return jacobian;
}

Fit fitted(const Problem& problem, const Fit& start, const FitLimits& limits) {
  Fit fit = start;
  const auto columns = columns_of(problem.structure, fit.causes);
  Solved now = solved_at(problem, fit);
  VectorXd error = residual(problem.observed, now.value);
  fit.chi_square = error.squaredNorm();
  double lambda = 1e-3;
  MatrixXd curvature;
  fit.converged = false;
  for (fit.iterations = 0; fit.iterations < limits.iterations && !fit.converged; ++fit.iterations) {
    const auto normal = normal_of(sensitivities(problem, fit.causes, fit.eta, now), error);
    VectorXd gradient = -normal.toward;
    curvature = normal.gram;
    add_prior(fit, columns, gradient, curvature);
    const double before = objective(problem, fit);
    bool taken = false;
    for (int attempt = 0; attempt < 8 && !taken; ++attempt) {
      MatrixXd damped = curvature;
      damped.diagonal() *= 1.0 + lambda;
      const VectorXd by = -damped.llt().solve(gradient);
      const double promised = -gradient.dot(by) - 0.5 * by.dot(curvature * by);
      Fit next = fit;
      step(problem.structure, next, columns, by);
      if (std::isfinite(prior_of(problem.structure, next.causes))) {
        Solved there = solved_at(problem, next);
        VectorXd left = residual(problem.observed, there.value);
        next.chi_square = left.squaredNorm();
        if (objective(problem, next) < before) {
          taken = true;
          fit = std::move(next);
          now = std::move(there);
          error = std::move(left);
        }
      }
      if (promised < limits.tolerance) {
        fit.converged = true;
        break;
      }
      lambda = taken ? std::max(1e-9, 0.1 * lambda) : std::max(1e-4, 10.0 * lambda);
    }
    if (!taken) break;
  }
  if (curvature.size() == 0) return fit;
  conclude(problem, curvature, fit);
  return fit;
}

}  // namespace chladni::diagnosis
