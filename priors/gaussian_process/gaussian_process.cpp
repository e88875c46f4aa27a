#include "priors/gaussian_process/gaussian_process.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "dense/algebra.h"

namespace chladni::priors {
namespace {

constexpr double kLogTwoPi = 1.8378770664093453;
constexpr Eigen::Index kBlock = 2048;  // places predicted at once

double log_determinant_of(const Eigen::MatrixXd& factor) {
  return 2.0 * factor.diagonal().array().log().sum();
}

}  // namespace

GaussianProcess::GaussianProcess(GaussianPrior prior, const Points& points,
                                 const Eigen::VectorXd& noise_variance)
    : prior_(std::move(prior)), points_(points), noise_(noise_variance) {
  require(noise_.size() == points_.rows(), "Gaussian process: " + fmt::to_string(points_.rows()) +
                                               " points and " + fmt::to_string(noise_.size()) +
                                               " noise variances; expected as many");
  require(points_.allFinite() && noise_.allFinite() && (noise_.array() >= 0.0).all(),
          "Gaussian process: a point or noise variance is not finite, or the latter is negative");
  require(prior_.amplitude > 0.0 && std::isfinite(prior_.amplitude),
          "Gaussian process: the amplitude is " + fmt::format("{:.6g}", prior_.amplitude) +
              "; expected a positive one");
  trend_ = prior_.trend.at(points_);
  require(trend_.cols() < points_.rows(),
          "Gaussian process: " + fmt::to_string(points_.rows()) + " values and a trend of " +
              fmt::to_string(trend_.cols()) + " functions; expected more values");
  factorise();
}

void GaussianProcess::factorise() {
  const auto fill = [&] {
    factor_ = covariance(prior_.kernel, prior_.parameters, points_);
    factor_.triangularView<Eigen::Lower>() *= prior_.amplitude * prior_.amplitude;
    factor_.diagonal() += noise_;
    return factor_.diagonal().mean();
  };
  const double scale = fill();
  for (double relative = 1e-14; !dense::cholesky(factor_); relative *= 100.0) {
    if (relative > 1e-4) {
      throw NumericalFailure("Gaussian process: the covariance of kernel " + prior_.kernel.name() +
                             " is not positive definite, even with 1e-4 of its diagonal added");
    }
    jitter_ = relative * scale;
    (void)fill();
    factor_.diagonal().array() += jitter_;
  }
  noise_.array() += jitter_;
  trend_solved_ = trend_;
  if (trend_.cols() == 0) return;
  Eigen::MatrixXd half = trend_;
  dense::solve(factor_, half);
  gram_factor_ = half.transpose() * half;
  Eigen::MatrixXd plain = trend_.transpose() * trend_;
  const bool sound = dense::cholesky(gram_factor_) && dense::cholesky(plain);
  require(sound, "Gaussian process: the functions of the trend are not independent at the points");
  gram_log_determinant_ = log_determinant_of(gram_factor_) - log_determinant_of(plain);
  trend_solved_ = std::move(half);
  dense::solve_transposed(factor_, trend_solved_);
}

void GaussianProcess::require_values(const Eigen::MatrixXd& values) const {
  require(values.rows() == points_.rows(), "Gaussian process: " + fmt::to_string(values.rows()) +
                                               " values at " + fmt::to_string(points_.rows()) +
                                               " points; expected as many");
}

double GaussianProcess::log_determinant() const {
  return log_determinant_of(factor_) + gram_log_determinant_;
}

Eigen::MatrixXd GaussianProcess::projected(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd solved = values;
  dense::solve(factor_, solved);
  dense::solve_transposed(factor_, solved);
  if (trend_.cols() == 0) return solved;
  Eigen::MatrixXd beta = trend_.transpose() * solved;
  dense::solve(gram_factor_, beta);
  dense::solve_transposed(gram_factor_, beta);
  solved -= trend_solved_ * beta;
  return solved;
}

Eigen::MatrixXd GaussianProcess::projected_inverse() const {
  Eigen::MatrixXd inverse = factor_;
  dense::invert(inverse);
  if (trend_.cols() == 0) return inverse;
  Eigen::MatrixXd half = trend_solved_.transpose();
  dense::solve(gram_factor_, half);
  dense::add_square(half.transpose(), -1.0, inverse);
  return inverse;
}

Score GaussianProcess::score(Merit merit, const Eigen::MatrixXd& values, bool best_factor) const {
  require_values(values);
  const Eigen::MatrixXd alpha = projected(values);
  const bool marginal = merit == Merit::marginal_likelihood;
  const double free =
      static_cast<double>(marginal ? points_.rows() - trend_.cols() : points_.rows());
  Eigen::VectorXd square = values.cwiseProduct(alpha).colwise().sum().transpose();
  double determinant = 0.0;
  if (marginal) {
    determinant = log_determinant();
  } else {
    const Eigen::VectorXd precision = projected_inverse().diagonal();
    square = alpha.array().square().matrix().transpose() * precision.cwiseInverse();
    determinant = -precision.array().log().sum();
  }
  Score score;
  score.factor = Eigen::VectorXd::Ones(values.cols());
  if (best_factor) {
    const Eigen::VectorXd smallest = 1e-24 * values.colwise().squaredNorm().transpose();
    const double tiny = std::numeric_limits<double>::min();
    score.factor = (square.cwiseMax(smallest) / free).cwiseMax(tiny).cwiseSqrt();
  }
  score.value = -0.5 * (square.array() / score.factor.array().square() + determinant +
                        free * (2.0 * score.factor.array().log() + kLogTwoPi));
  return score;
}

Slopes GaussianProcess::slopes(Merit merit, const Eigen::MatrixXd& values,
                               const Eigen::VectorXd& factor) const {
  require_values(values);
  return merit == Merit::marginal_likelihood ? likelihood_slopes(values, factor)
                                             : leave_one_out_slopes(values, factor);
}

// dL/dt = ½ (αᵀ dC α − tr(P dC)); a² dK/da² follows from C = a² K + N without a further product.
Slopes GaussianProcess::likelihood_slopes(const Eigen::MatrixXd& values,
                                          const Eigen::VectorXd& factor) const {
  const Eigen::MatrixXd alpha = projected(values) * factor.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = projected_inverse();
  const auto sums = contractions(prior_.kernel, prior_.parameters, points_, inverse, alpha);
  const double variance = prior_.amplitude * prior_.amplitude;
  Slopes slopes;
  slopes.parameters = 0.5 * variance * (sums.forms.colwise() - sums.weighted);
  const Eigen::VectorXd noise_square = alpha.array().square().matrix().transpose() * noise_;
  const double noise_trace = noise_.dot(inverse.diagonal());
  slopes.noise = 0.5 * (noise_square.array() - noise_trace);
  const Eigen::VectorXd square =
      (values * factor.cwiseInverse().asDiagonal()).cwiseProduct(alpha).colwise().sum().transpose();
  const double free = static_cast<double>(points_.rows() - trend_.cols());
  slopes.amplitude = (square - noise_square).array() - (free - noise_trace);
  return slopes;
}

// dL = tr(W dC), W = −P diag(c) P + sym(α (P b)ᵀ), c = ½ (1 / p + α² / p²), b = α / p, p = diag P
// (Rasmussen and Williams 2006, (5.13), written as one matrix).
Slopes GaussianProcess::leave_one_out_slopes(const Eigen::MatrixXd& values,
                                             const Eigen::VectorXd& factor) const {
  const Eigen::MatrixXd all = projected(values) * factor.cwiseInverse().asDiagonal();
  Eigen::MatrixXd inverse = projected_inverse();
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
  const Eigen::VectorXd precision = inverse.diagonal();
  Slopes slopes;
  slopes.parameters.resize(prior_.parameters.size(), values.cols());
  slopes.amplitude.resize(values.cols());
  slopes.noise.resize(values.cols());
  const double variance = prior_.amplitude * prior_.amplitude;
  const Eigen::MatrixXd none(points_.rows(), 0);
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    const Eigen::ArrayXd alpha = all.col(i).array();
    const Eigen::ArrayXd p = precision.array();
    const Eigen::VectorXd root = (0.5 * (1.0 / p + alpha.square() / p.square())).sqrt();
    const Eigen::VectorXd back = inverse * (alpha / p).matrix();
    Eigen::MatrixXd weights = 0.5 * (all.col(i) * back.transpose() + back * all.col(i).transpose());
    dense::add_square(inverse * root.asDiagonal(), -1.0, weights);
    slopes.parameters.col(i) =
        variance * contractions(prior_.kernel, prior_.parameters, points_, weights, none).weighted;
    const double noise = noise_.dot(weights.diagonal());
    const double scaled = -static_cast<double>(p.size()) + (alpha.square() / p).sum();
    slopes.noise(i) = noise;
    slopes.amplitude(i) = scaled - 2.0 * noise;
  }
  return slopes;
}

LeaveOneOut GaussianProcess::leave_one_out(const Eigen::MatrixXd& values) const {
  require_values(values);
  LeaveOneOut result;
  result.variance = projected_inverse().diagonal().cwiseInverse();
  result.mean = values - result.variance.asDiagonal() * projected(values);
  return result;
}

Eigen::MatrixXd GaussianProcess::weights(const Points& places) const {
  const double variance = prior_.amplitude * prior_.amplitude;
  Eigen::MatrixXd solved = variance * covariance(prior_.kernel, prior_.parameters, points_, places);
  Eigen::MatrixXd free = prior_.trend.at(places).transpose();
  if (free.rows() > 0) free -= trend_solved_.transpose() * solved;
  dense::solve(factor_, solved);
  dense::solve_transposed(factor_, solved);
  if (free.rows() > 0) {
    dense::solve(gram_factor_, free);
    dense::solve_transposed(gram_factor_, free);
    solved += trend_solved_ * free;
  }
  return solved.transpose();
}

Prediction GaussianProcess::at(const Points& places, const Eigen::MatrixXd& values) const {
  require_values(values);
  const double variance = prior_.amplitude * prior_.amplitude;
  const Eigen::MatrixXd alpha = projected(values);
  Eigen::MatrixXd beta = trend_solved_.transpose() * values;
  if (trend_.cols() > 0) {
    dense::solve(gram_factor_, beta);
    dense::solve_transposed(gram_factor_, beta);
  }
  Prediction result;
  result.mean.resize(places.rows(), values.cols());
  result.deviation.resize(places.rows());
  for (Eigen::Index first = 0; first < places.rows(); first += kBlock) {
    const Eigen::Index count = std::min(kBlock, places.rows() - first);
    const Points here = places.middleRows(first, count);
    Eigen::MatrixXd across = variance * covariance(prior_.kernel, prior_.parameters, points_, here);
    auto mean = result.mean.middleRows(first, count);
    mean = across.transpose() * alpha;
    Eigen::VectorXd left = variance * variances(prior_.kernel, prior_.parameters, here);
    Eigen::MatrixXd free = prior_.trend.at(here).transpose();
    if (free.rows() > 0) {
      mean += free.transpose() * beta;
      free -= trend_solved_.transpose() * across;
      dense::solve(gram_factor_, free);
      left += free.colwise().squaredNorm().transpose();
    }
    dense::solve(factor_, across);
    left -= across.colwise().squaredNorm().transpose();
    result.deviation.segment(first, count) = left.cwiseMax(0.0).cwiseSqrt();
  }
  return result;
}

}  // namespace chladni::priors
