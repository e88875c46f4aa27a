#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "priors/learning.h"

namespace chladni::priors {
namespace {

void require_sound(const Kernel& kernel, const Task& task, int lengths) {
  require(kernel.parameter_count() == 1, "matched length: kernel " + kernel.name() + " has " +
                                             fmt::to_string(kernel.parameter_count()) +
                                             " hyper-parameters; expected one");
  require(task.at_places.rows() == task.places.rows() &&
              task.on_surface.rows() == task.surface.rows() &&
              task.area.size() == task.surface.rows() &&
              task.at_places.cols() == task.on_surface.cols() && task.at_places.cols() > 0,
          "matched length: shapes, places, surface and area do not fit each other");
  require(task.noise > 0.0 && lengths > 2,
          "matched length: the noise must be positive and the grid of three lengths or more");
}

// Mean squared error over the square of each shape; the values give the amplitudes.
double mean_error(const Kernel& kernel, const Task& task, double length) {
  const Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, length);
  const Eigen::MatrixXd k = covariance(kernel, theta, task.places);
  const Eigen::MatrixXd trend = task.trend.at(task.places);
  double sum = 0.0;
  for (Eigen::Index f = 0; f < task.at_places.cols(); ++f) {
    const double square = task.on_surface.col(f).cwiseAbs2().dot(task.area);
    const double variance = task.noise * task.noise * square / task.area.sum();
    const Eigen::VectorXd noise = Eigen::VectorXd::Constant(task.places.rows(), variance);
    const double amplitude = best_amplitude(k, noise, trend, task.at_places.col(f));
    const GaussianProcess process({kernel, theta, amplitude, task.trend}, task.places, noise);
    // The noise is not drawn; its expectation is added to the squared error.
    const Eigen::MatrixXd weights = process.weights(task.surface);
    const Eigen::VectorXd off = weights * task.at_places.col(f) - task.on_surface.col(f);
    const Eigen::VectorXd error = off.cwiseAbs2() + variance * weights.rowwise().squaredNorm();
    sum += error.dot(task.area) / square;
  }
  return sum / static_cast<double>(task.at_places.cols());
}

// Expected error of a random shape: E |W (Ψ_S c + e) − Ψ c|² / E |Ψ c|².
double expected_error(const Kernel& kernel, const Task& task, double length) {
  const Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, length);
  const double square = task.on_surface.rowwise().squaredNorm().dot(task.area) / task.area.sum();
  const double variance = task.noise * task.noise * square;
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(task.places.rows(), variance);
  const GaussianProcess process({kernel, theta, std::sqrt(square), task.trend}, task.places, noise);
  const Eigen::MatrixXd weights = process.weights(task.surface);
  const Eigen::MatrixXd off = weights * task.at_places - task.on_surface;
  const Eigen::VectorXd error =
      off.rowwise().squaredNorm() + variance * weights.rowwise().squaredNorm();
  return error.dot(task.area) / (square * task.area.sum());
}

using ErrorOf = double (*)(const Kernel& kernel, const Task& task, double length);

MatchedLength best_on_grid(ErrorOf error, const Kernel& kernel, const Task& task, int lengths) {
  require_sound(kernel, task, lengths);
  const auto [low, high] = length_range(task.places);
  MatchedLength result;
  result.lengths.resize(lengths);
  result.errors.resize(lengths);
  for (Eigen::Index k = 0; k < lengths; ++k) {
    const double part = static_cast<double>(k) / (lengths - 1);
    result.lengths(k) = low * std::pow(high / low, part);
    result.errors(k) = error(kernel, task, result.lengths(k));
  }
  Eigen::Index best = 0;
  result.error = result.errors.minCoeff(&best);
  result.length = result.lengths(best);
  result.at_bound = best == 0 || best == lengths - 1;
  return result;
}

}  // namespace

MatchedLength matched_length(const Kernel& kernel, const Task& task, int lengths) {
  return best_on_grid(mean_error, kernel, task, lengths);
}

MatchedLength expected_length(const Kernel& kernel, const Task& task, int lengths) {
  return best_on_grid(expected_error, kernel, task, lengths);
}

}  // namespace chladni::priors
