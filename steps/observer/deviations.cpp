#include "steps/observer/deviations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

// Whether a state integrates a disturbance: that grows without bound, whatever the mode does.
bool is_drift(const Eigen::MatrixXd& a, Eigen::Index s) {
  return a(s, s) == 1.0 && (a.row(s).array() != 0.0).count() == 1;
}

// The two states of a mode and all that move them, directly or through others; beyond those of the
// plant drifts are left out where this is asked.
std::vector<Eigen::Index> states_of_mode(const Eigen::MatrixXd& a, Eigen::Index m,
                                         Eigen::Index plant, bool with_drifts) {
  std::vector<Eigen::Index> states{2 * m, 2 * m + 1};
  for (std::size_t k = 0; k < states.size(); ++k) {
    for (Eigen::Index s = 0; s < a.cols(); ++s) {
      if (a(states[k], s) == 0.0 || std::ranges::find(states, s) != states.end()) continue;
      if (with_drifts || s < plant || !is_drift(a, s)) states.push_back(s);
    }
  }
  return states;
}

// Rms of one mode's coordinate under the disturbances alone, by itself with what moves it; infinite
// where that drifts.
double amplitude_of(const Observer& observer, Eigen::Index m, bool with_drifts) {
  const auto& a = observer.filter.system.model.space.a;
  const auto& t = observer.coordinates;
  const auto states = states_of_mode(a, m, t.cols(), with_drifts);
  const Eigen::MatrixXd own = observer.filter.system.noise_inputs()(states, Eigen::all);
  try {
    const Eigen::MatrixXd p =
        dense::stationary_covariance(a(states, states), own * own.transpose());
    const Eigen::RowVector2d row = t.row(m).segment<2>(2 * m);
    return std::sqrt(std::max(0.0, (row * p.topLeftCorner<2, 2>()).dot(row)));
  } catch (const NumericalFailure&) {
    return kInfinite;
  }
}

// Rms of each mode's coordinate under the disturbances alone. Where a state drifts, each mode is
// taken by itself: only one that drifts is infinite.
Eigen::RowVectorXd amplitudes_of(const Observer& observer, const Eigen::MatrixXd& moments) {
  const auto& t = observer.coordinates;
  if (moments.size() > 0) {
    const auto plant = moments.topLeftCorner(t.cols(), t.cols());
    return (t * plant * t.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt().transpose();
  }
  Eigen::RowVectorXd amplitudes(t.rows());
  for (Eigen::Index m = 0; m < t.rows(); ++m) amplitudes(m) = amplitude_of(observer, m, true);
  return amplitudes;
}

// The deviation of each coordinate given the samples over its amplitude. Where a drift moves a
// mode, over that under the other disturbances; 0 of a mode that drifts by itself.
Eigen::VectorXd unknown_parts(const Observer& observer, const Eigen::RowVectorXd& amplitudes) {
  const auto& t = observer.coordinates;
  const auto left = observer.filter.covariance.topLeftCorner(t.cols(), t.cols());
  Eigen::VectorXd parts = (t * left * t.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Eigen::Index m = 0; m < parts.size(); ++m) {
    const bool drifts = std::isinf(amplitudes(m));
    const double amplitude = drifts ? amplitude_of(observer, m, false) : amplitudes(m);
    parts(m) = amplitude > 0.0 ? parts(m) / amplitude : 0.0;
    if (drifts) parts(m) = std::min(1.0, parts(m));
  }
  return parts;
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
  if (moments.size() > 0) {
    const Eigen::MatrixXd c = filter.system.model.space.c.bottomRows(n);
    const Eigen::MatrixXd through = filter.system.noise_through().bottomRows(n);
    result.without =
        ((c * moments * c.transpose()).diagonal() + (through * through.transpose()).diagonal())
            .cwiseMax(0.0)
            .cwiseSqrt();
  }
  const auto amplitudes = amplitudes_of(result, moments);
  result.unknown_part = unknown_parts(result, amplitudes);
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
