#include "priors/surface_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "priors/optimum.h"
#include "priors/random_coefficients.h"

namespace chladni::priors {
namespace {

constexpr int kGrid = 16;

struct Evidence {
  double value = 0.0, slope = 0.0;  // by ln(length)
};

struct Problem {
  const Eigen::VectorXd &values, &noise;
  const Eigen::MatrixXd& harmonics;
  const Eigen::VectorXd &eigenvalue, &mean_square;
  double smoothness;

  [[nodiscard]] Evidence at(double log_length) const {
    const auto known =
        harmonic_variances(eigenvalue, mean_square, std::exp(log_length), smoothness);
    const RandomCoefficients random(harmonics * known.value.cwiseSqrt().asDiagonal(), values,
                                    noise);
    return {random.log_evidence(), random.variance_slopes().dot(known.slopes)};
  }
};

// ln of the shortest and the longest length that can be told.
std::pair<double, double> range(const Eigen::VectorXd& eigenvalue) {
  const double highest = eigenvalue.maxCoeff();
  const double lowest =
      (eigenvalue.array() > 1e-9 * highest).select(eigenvalue, highest).minCoeff();
  require(highest > 0.0, "surface kernel: all harmonics are constant");
  return {std::log(2.0 / std::sqrt(highest)), std::log(2.0 * std::numbers::pi / std::sqrt(lowest))};
}

}  // namespace

HarmonicVariances harmonic_variances(const Eigen::VectorXd& eigenvalue,
                                     const Eigen::VectorXd& mean_square, double length,
                                     double smoothness) {
  require(length > 0.0 && smoothness > 0.0, "surface kernel: length " + std::to_string(length) +
                                                " m, smoothness " + std::to_string(smoothness) +
                                                "; expected more than 0");
  const Eigen::ArrayXd square = eigenvalue.array().max(0.0) * length * length;
  HarmonicVariances variances;
  if (std::isinf(smoothness)) {
    variances.value = (-0.5 * square).exp();
    variances.slopes = -square;
  } else {
    const Eigen::ArrayXd x = square / (2.0 * smoothness);
    variances.value = (-(smoothness + 1.0) * (1.0 + x).log()).exp();
    variances.slopes = -2.0 * (smoothness + 1.0) * x / (1.0 + x);
  }
  variances.value /= variances.value.dot(mean_square);
  const double turn = variances.value.cwiseProduct(mean_square).dot(variances.slopes);
  variances.slopes.array() -= turn;
  return variances;
}

Eigen::MatrixXd surface_covariance(const HarmonicVariances& variances, const Eigen::MatrixXd& a,
                                   const Eigen::MatrixXd& b) {
  require(a.cols() == variances.value.size() && b.cols() == a.cols(),
          "surface kernel: " + std::to_string(a.cols()) + " and " + std::to_string(b.cols()) +
              " harmonics, expected " + std::to_string(variances.value.size()));
  return a * variances.value.asDiagonal() * b.transpose();
}

SurfaceLength learned_length(const Eigen::VectorXd& values, const Eigen::VectorXd& noise,
                             const Eigen::MatrixXd& harmonics, const Eigen::VectorXd& eigenvalue,
                             const Eigen::VectorXd& mean_square, double smoothness) {
  require(harmonics.rows() == values.size() && harmonics.cols() == eigenvalue.size() &&
              mean_square.size() == eigenvalue.size() && eigenvalue.size() > 1,
          "surface kernel: harmonics are " + std::to_string(harmonics.rows()) + "x" +
              std::to_string(harmonics.cols()) + "; expected places x eigenvalues, " +
              std::to_string(values.size()) + "x" + std::to_string(eigenvalue.size()));
  const Problem problem{values, noise, harmonics, eigenvalue, mean_square, smoothness};
  const auto [low, high] = range(eigenvalue);
  double best = low;
  double value = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < kGrid; ++k) {
    const double log_length = low + (high - low) * k / (kGrid - 1);
    const double there = problem.at(log_length).value;
    if (there > value) {
      value = there;
      best = log_length;
    }
  }
  const auto found = minimum(
      [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
        const auto evidence = problem.at(at(0));
        gradient(0) = -evidence.slope;
        return -evidence.value;
      },
      Eigen::VectorXd::Constant(1, best), Eigen::VectorXd::Constant(1, low),
      Eigen::VectorXd::Constant(1, high));
  return {std::exp(found.at(0)), -found.value, found.at_bound.front()};
}

}  // namespace chladni::priors
