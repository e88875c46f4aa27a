#include "diagnosis/verdict/held_out/part_misfit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "dense/algebra.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/quadratic.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The deviations with the prediction, the residual and ½(χ² + ηᵀη).
struct PartPoint {
  VectorXd eta;
  Solved now;
  VectorXd error;
  double misfit = HUGE_VAL;
};

// None where the state is impossible.
std::optional<PartPoint> part_point(const Problem& problem, const std::vector<Supposed>& causes,
                                    VectorXd eta) {
  try {
    const State state = state_of(problem, causes, eta);
    PartPoint point{std::move(eta), solved(state, Body(state, problem.observed.omega)), {}};
    point.error = residual(problem.observed, point.now.value);
    point.misfit = 0.5 * point.error.squaredNorm() + 0.5 * point.eta.squaredNorm();
    return point;
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

// Rows of the residual that have a weight: real parts, then imaginary parts.
std::vector<Index> weighted_rows(const Observed& observed) {
  std::vector<Index> rows;
  const Index numbers = observed.weight.size();
  for (const Index half : {Index{0}, numbers}) {
    for (Index i = 0; i < numbers; ++i) {
      if (observed.weight.data()[i] > 0.0) rows.push_back(half + i);
    }
  }
  return rows;
}

Quadratic quadratic_at(const Problem& problem, const std::vector<Supposed>& causes,
                       const std::vector<Index>& rows, const PartPoint& here) {
  const MatrixXd slopes =
      sensitivities_of_deviations(problem, causes, here.eta, here.now)(rows, Eigen::all);
  MatrixXd gram = MatrixXd::Identity(slopes.cols(), slopes.cols());
  dense::add_gram(slopes, gram);
  return {here.eta - slopes.transpose() * here.error(rows), gram.selfadjointView<Eigen::Lower>()};
}

// Makes a step that lowers the misfit; false: none was found.
bool lowered(const Problem& problem, const std::vector<Supposed>& causes,
             const Quadratic& quadratic, PartPoint& here, double& lambda) {
  constexpr int kAttempts = 6;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    auto next = part_point(problem, causes, here.eta + quadratic.step(lambda));
    if (next && next->misfit < here.misfit) {
      here = std::move(*next);
      lambda *= 0.1;
      return true;
    }
    lambda = std::max(0.1, 10.0 * lambda);
  }
  return false;
}

}  // namespace

double misfit_at(const Problem& problem, const std::vector<Supposed>& causes, const VectorXd& eta) {
  const auto point = part_point(problem, causes, eta);
  return point ? point->misfit : HUGE_VAL;
}

double least_misfit(const Problem& problem, const std::vector<Supposed>& causes,
                    const std::vector<VectorXd>& starts) {
  std::optional<PartPoint> here;
  for (const auto& eta : starts) {
    auto point = part_point(problem, causes, eta);
    if (point && (!here || point->misfit < here->misfit)) here = std::move(point);
  }
  if (!here) return HUGE_VAL;
  const auto rows = weighted_rows(problem.observed);
  double lambda = 0.0;
  for (int step = 0; step < kConstants.part_steps; ++step) {
    const Quadratic quadratic = quadratic_at(problem, causes, rows, *here);
    if (quadratic.promised(quadratic.step(0.0)) < kConstants.nothing_more) break;
    if (!lowered(problem, causes, quadratic, *here, lambda)) break;
  }
  return here->misfit;
}

}  // namespace chladni::diagnosis
