#include "priors/spline/surface_kernel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "base/error.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

// ln of the shortest and of the longest length that the harmonics resolve.
std::pair<double, double> length_range(const Eigen::VectorXd& eigenvalue) {
  const double highest = eigenvalue.maxCoeff();
  require(highest > 0.0, "surface kernel: all harmonics are constant");
  const double lowest =
      (eigenvalue.array() > 1e-9 * highest).select(eigenvalue, highest).minCoeff();
  return {std::log(2.0 / std::sqrt(highest)), std::log(2.0 * std::numbers::pi / std::sqrt(lowest))};
}

}  // namespace

Eigen::VectorXd harmonic_variances(const Eigen::VectorXd& eigenvalue,
                                   const Eigen::VectorXd& mean_square, double length,
                                   double smoothness) {
  require(length > 0.0 && smoothness > 0.0,
          "surface kernel: length " + fmt::format("{:.6g}", length) + " m, smoothness " +
              fmt::format("{:.6g}", smoothness) + "; expected more than 0");
  const Eigen::ArrayXd square = eigenvalue.array().max(0.0) * length * length;
  const Eigen::VectorXd density =
      std::isinf(smoothness)
          ? Eigen::VectorXd((-0.5 * square).exp())
          : Eigen::VectorXd(
                (-(smoothness + 1.0) * (1.0 + square / (2.0 * smoothness)).log()).exp());
  return density / density.dot(mean_square);
}

Eigen::MatrixXd surface_covariance(const Eigen::VectorXd& variances, const Eigen::MatrixXd& a,
                                   const Eigen::MatrixXd& b) {
  require(a.cols() == variances.size() && b.cols() == a.cols(),
          "surface kernel: " + fmt::to_string(a.cols()) + " and " + fmt::to_string(b.cols()) +
              " harmonics, expected " + fmt::to_string(variances.size()));
  return a * variances.asDiagonal() * b.transpose();
}

Smoother surface_smoother(const SurfaceFit& fit, const Eigen::MatrixXd& harmonics) {
  return {surface_covariance(fit.variances, harmonics, harmonics),
          Eigen::MatrixXd::Ones(harmonics.rows(), 1), fit.noise};
}

SurfaceFit surface_fit(const Eigen::VectorXd& values, const Eigen::VectorXd& noise,
                       const Eigen::MatrixXd& harmonics, const Eigen::VectorXd& eigenvalue,
                       const Eigen::VectorXd& mean_square, double smoothness) {
  require(harmonics.rows() == values.size() && noise.size() == values.size() &&
              harmonics.cols() == eigenvalue.size() && mean_square.size() == eigenvalue.size() &&
              eigenvalue.size() > 1,
          "surface kernel: harmonics are " + fmt::to_string(harmonics.rows()) + "x" +
              fmt::to_string(harmonics.cols()) + "; expected places x eigenvalues, " +
              fmt::to_string(values.size()) + "x" + fmt::to_string(eigenvalue.size()));
  const double level = std::exp(noise.array().log().mean());
  const auto [low, high] = length_range(eigenvalue);
  SurfaceFit best;
  for (int k = 0; k < Constants::surface_lengths; ++k) {
    SurfaceFit fit;
    fit.length = std::exp(low + (high - low) * k / (Constants::surface_lengths - 1));
    fit.at_bound = k == 0 || k == Constants::surface_lengths - 1;
    fit.variances = harmonic_variances(eigenvalue, mean_square, fit.length, smoothness);
    fit.noise = noise / level;
    fit.smoothing =
        surface_smoother(fit, harmonics).chosen(values, SmoothingRule::reml_known_noise, level);
    if (k == 0 || fit.smoothing.log_likelihood > best.smoothing.log_likelihood) {
      best = std::move(fit);
    }
  }
  return best;
}

}  // namespace chladni::priors
