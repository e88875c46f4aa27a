#include "steps/observer/deviations.h"

#include <cmath>
#include <limits>

#include "base/error.h"
#include "dense/riccati.h"

namespace chladni::steps {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Second moments of the states under the disturbances alone; empty where a state drifts.
Eigen::MatrixXd open_moments(const modal::DisturbedModel& system) {
  const Eigen::MatrixXd moved = system.noise_inputs();
  try {
    return dense::stationary_covariance(system.model.space.a, moved * moved.transpose());
  } catch (const NumericalFailure&) {
    return {};
  }
}

// Σ (deviation · coordinate)²: 0 where the deviation is, infinite where it is not known.
double shape_variance(const Eigen::RowVectorXd& deviation, const Eigen::RowVectorXd& coordinates) {
  double sum = 0.0;
  for (Eigen::Index m = 0; m < deviation.size(); ++m) {
    if (!std::isfinite(deviation(m))) return kInfinite;
    if (deviation(m) > 0.0) sum += std::pow(deviation(m) * coordinates(m), 2);
  }
  return sum;
}

}  // namespace

void set_deviations(Observer& result) {
  const auto& filter = result.filter;
  const auto n = std::ssize(result.places.points);
  const auto widened = [&](const Eigen::MatrixXd& covariance) -> Eigen::VectorXd {
    return result.band_factor * covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  };
  result.deviation = widened(filter.point_covariance);
  result.prediction = widened(filter.prediction_covariance);
  const auto moments = open_moments(filter.system);
  result.without = Eigen::VectorXd::Constant(n, kInfinite);
  result.shape_deviation = Eigen::VectorXd::Constant(n, kInfinite);
  const auto& deviation = result.places.at_points.deviation;
  Eigen::RowVectorXd amplitudes = Eigen::RowVectorXd::Constant(deviation.cols(), kInfinite);
  if (moments.size() > 0) {
    const Eigen::MatrixXd c = filter.system.model.space.c.bottomRows(n);
    const Eigen::MatrixXd through = filter.system.noise_through().bottomRows(n);
    result.without =
        ((c * moments * c.transpose()).diagonal() + (through * through.transpose()).diagonal())
            .cwiseMax(0.0)
            .cwiseSqrt();
    const auto& t = result.coordinates;
    const auto plant = moments.topLeftCorner(t.cols(), t.cols());
    amplitudes = (t * plant * t.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt().transpose();
  }
  const auto& t = result.coordinates;
  const auto left = filter.covariance.topLeftCorner(t.cols(), t.cols());
  result.unknown_part = (t * left * t.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt().array() /
                        amplitudes.transpose().array().max(1e-300);
  for (Eigen::Index i = 0; i < n; ++i) {
    result.shape_deviation(i) = std::sqrt(shape_variance(deviation.row(i), amplitudes));
  }
}

Eigen::MatrixXd band(const Observer& observer, const Eigen::MatrixXd& states) {
  const auto n = std::ssize(observer.places.points);
  Eigen::MatrixXd result(states.rows(), n);
  const auto& t = observer.coordinates;
  const Eigen::MatrixXd coordinates = states.leftCols(t.cols()) * t.transpose();
  for (Eigen::Index k = 0; k < states.rows(); ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& deviation = observer.places.at_points.deviation.row(i);
      result(k, i) = std::sqrt(std::pow(observer.deviation(i), 2) +
                               shape_variance(deviation, coordinates.row(k)));
    }
  }
  return result;
}

}  // namespace chladni::steps
