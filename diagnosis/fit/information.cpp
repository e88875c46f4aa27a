#include "diagnosis/fit/information.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "dense/algebra.h"
#include "diagnosis/fit/sensitivities.h"

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Length of the surface along an axis over that along the other one: of its box, and of the places
// of its scan where the body has no parts.
double slenderness(const Structure& structure, Index axis) {
  const auto& places = structure.surface.places;
  Eigen::Vector2d sides = structure.cells.size;
  if (!(sides.minCoeff() > 0.0)) sides = places.colwise().maxCoeff() - places.colwise().minCoeff();
  return sides.minCoeff() > 0.0 ? sides(axis) / sides(1 - axis) : 1.0;
}

}  // namespace

double prior_width(const Structure& structure, const Parameter& parameter) {
  if (!parameter.is_place()) return parameter.width;
  const double area = structure.surface.area.sum();
  const Index axis = parameter.role == Parameter::Role::place_u ? 0 : 1;
  return std::sqrt(area * slenderness(structure, axis) / (2.0 * std::numbers::pi));
}

MatrixXd tolerated_variance(const Problem& problem, const Fit& fit, const Solved& now) {
  const MatrixXd jacobian = sensitivities_of_deviations(problem, fit.causes, fit.eta, now);
  const Index n = problem.observed.value.size();
  // The rows are weighted; each is the real or the imaginary part of one response.
  const VectorXd power = jacobian.rowwise().squaredNorm();
  const Eigen::ArrayXXd weight2 = problem.observed.weight.array().square();
  const Eigen::ArrayXXd sum =
      (power.head(n) + power.tail(n))
          .reshaped(problem.observed.value.rows(), problem.observed.value.cols())
          .array();
  return (weight2 > 0.0).select(sum / weight2.max(1e-300), 0.0);
}

Information::Information(const Problem& problem, const Observed& slopes) {
  const Eigen::ArrayXXd weight = slopes.weight.array().max(1e-300);
  const VectorXd ratio = (problem.observed.weight.array() / weight).matrix().reshaped();
  rows_.resize(2 * ratio.size());
  rows_ << ratio, ratio;
  const VectorXd eta = VectorXd::Zero(static_cast<Index>(problem.deviations.size()));
  const State state = state_of(problem, {}, eta);
  const Solved now = solved(state, Body(state, problem.observed.omega));
  eta_ = eta;
  take(sensitivities(problem, {}, eta, now));
}

Information::Information(const Problem& problem, const Fit& about) {
  rows_ = VectorXd::Ones(2 * problem.observed.value.size());
  const State state = state_of(problem, about.causes, about.eta);
  const Solved now = solved(state, Body(state, problem.observed.omega));
  MatrixXd jacobian = sensitivities(problem, about.causes, about.eta, now);
  Index column = 0;
  for (const auto& cause : about.causes) {
    for (const auto& parameter : cause.effect->parameters(problem.structure)) {
      jacobian.col(column++) *= prior_width(problem.structure, parameter);
    }
  }
  eta_ = VectorXd::Zero(jacobian.cols());
  eta_.tail(about.eta.size()) = about.eta;
  take(jacobian);
}

void Information::take(const MatrixXd& jacobian) {
  if (jacobian.cols() == 0) return;
  factor_ = MatrixXd::Identity(jacobian.cols(), jacobian.cols());
  dense::add_gram(jacobian, factor_);
  if (!dense::cholesky(factor_)) throw NumericalFailure("tolerances without bounds");
  jacobian_ = jacobian.transpose();
}

MatrixXd Information::taken(const MatrixXd& slopes) const {
  MatrixXd taken = MatrixXd::Zero(jacobian_.rows(), slopes.cols());
  if (factor_.size() == 0) return taken;
  dense::add_product(jacobian_, slopes, 1.0, taken);
  dense::solve(factor_, taken);
  return taken;
}

MatrixXd Information::of(const MatrixXd& slopes) const {
  const MatrixXd own = rows_.asDiagonal() * slopes;
  MatrixXd information = MatrixXd::Zero(own.cols(), own.cols());
  dense::add_gram(own, information);
  if (factor_.size() > 0) {
    MatrixXd less = MatrixXd::Zero(own.cols(), own.cols());
    dense::add_gram(taken(own), less);
    information -= less;
  }
  return information.selfadjointView<Eigen::Lower>();
}

Information::Score Information::scored(const MatrixXd& slopes, const VectorXd& left) const {
  const MatrixXd own = rows_.asDiagonal() * slopes;
  const VectorXd rest = rows_.cwiseProduct(left);
  Score result{own.transpose() * rest, own.colwise().squaredNorm()};
  if (factor_.size() == 0) return result;
  const MatrixXd less = taken(own);
  MatrixXd pull = jacobian_ * rest - eta_;
  dense::solve(factor_, pull);
  result.score -= less.transpose() * pull;
  result.information -= less.colwise().squaredNorm().transpose();
  return result;
}

}  // namespace chladni::diagnosis
