#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "base/error.h"
#include "base/finite.h"
#include "base/search.h"
#include "priors/constants.h"
#include "priors/gaussian_process/gaussian_process.h"

namespace chladni::priors {
namespace {

// The ln a² between low and high of the least −2 ln p(z) of independent z_j ~ N(0, 1 + a² λ_j).
double most_likely_log_square(const Eigen::ArrayXd& lambda, const Eigen::ArrayXd& square,
                              double low, double high) {
  const auto misfit = [&](double log_square) {
    const Eigen::ArrayXd variance = 1.0 + std::exp(log_square) * lambda;
    return (variance.log() + square / variance).sum();
  };
  const auto slope = [&](double log_square) {
    const Eigen::ArrayXd variance = 1.0 + std::exp(log_square) * lambda;
    return ((variance - 1.0) / variance * (1.0 - square / variance)).sum();
  };
  return minimum_in(misfit, slope, low, high, Constants::process_intervals).at;
}

}  // namespace

// After whitening by the noise and removal of the trend, the values are independent in the
// eigenbasis of the covariance.
double best_amplitude(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& noise_variance,
                      const Eigen::MatrixXd& trend, const Eigen::VectorXd& values) {
  require((noise_variance.array() > 0.0).all(),
          "amplitude of a Gaussian process: a noise variance is not positive");
  const Eigen::VectorXd white = noise_variance.cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd matrix = covariance.selfadjointView<Eigen::Lower>();
  matrix = white.asDiagonal() * matrix * white.asDiagonal();
  Eigen::VectorXd z = white.cwiseProduct(values);
  if (trend.cols() > 0) {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd(white.asDiagonal() * trend));
    const Eigen::MatrixXd basis = qr.householderQ();
    const auto rest = basis.rightCols(values.size() - trend.cols());
    matrix = rest.transpose() * matrix * rest;
    z = rest.transpose() * z;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      finite(matrix, "covariance of a Gaussian process"));
  const Eigen::ArrayXd lambda = eigen.eigenvalues().array().max(0.0);
  const Eigen::ArrayXd square = (eigen.eigenvectors().transpose() * z).array().square();
  // Range of the variance: 1e-4 of the noise's to 1e6 times the one that the values would need.
  const double mean = lambda.mean();
  const double low = std::log(1e-4 / mean);
  const double high = std::max(low + 1.0, std::log(1e6 * (1.0 + square.mean()) / mean));
  return std::exp(0.5 * most_likely_log_square(lambda, square, low, high));
}

}  // namespace chladni::priors
