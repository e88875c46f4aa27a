#include "priors/spline/smoother.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/finite.h"
#include "base/search.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

constexpr double kRankLost = 1e-10;     // relative to the triangle's largest entry
constexpr double kIndefinite = 1e-8;    // relative to the largest eigenvalue
constexpr double kRounding = 1e-14;     // relative to the kernel
constexpr double kNoEnergy = 1e-13;     // smaller eigenvalues are 0: places at one point
constexpr double kAlone = 1e-10;        // of a value in the contrasts: it fixes the free part alone
constexpr double kNothingLeft = 1e-26;  // of the values' squares: the values lie in the free part

constexpr double kFlat = std::numeric_limits<double>::infinity();
const double kLogTwoPi = std::log(2.0 * std::numbers::pi);

// Minus log likelihood of contrasts z with variances noise²/h, and its slope by ln λ.
Smoother::Criterion likelihood(const Eigen::ArrayXd& z, const Eigen::ArrayXd& h, double noise) {
  const Eigen::ArrayXd square = (z / noise).square() * h;
  const auto count = static_cast<double>(z.size());
  return {0.5 * ((square - h.log()).sum() + count * (kLogTwoPi + 2.0 * std::log(noise))),
          0.5 * ((1.0 - h) * (square - 1.0)).sum()};
}

Smoother::Criterion profiled_likelihood(const Eigen::ArrayXd& z, const Eigen::ArrayXd& h) {
  const auto count = static_cast<double>(z.size());
  const double sum = (z.square() * h).sum();
  const double slope = count * (z.square() * h * (1.0 - h)).sum() / sum - (1.0 - h).sum();
  return {0.5 * (count * (kLogTwoPi + std::log(sum / count) + 1.0) - h.log().sum()), 0.5 * slope};
}

}  // namespace

Smoother::Smoother(const Eigen::MatrixXd& kernel, const Eigen::MatrixXd& trend,
                   const Eigen::VectorXd& deviation)
    : deviation_(deviation) {
  const auto n = kernel.rows();
  const auto p = trend.cols();
  require(kernel.cols() == n && trend.rows() == n && deviation.size() == n && n >= p && p > 0,
          "smoother: the kernel has " + fmt::to_string(n) + " rows, the free part " +
              fmt::to_string(trend.rows()) + " and " + fmt::to_string(p) + " columns, the noise " +
              fmt::to_string(deviation.size()) + "; expected n, n, p <= n and n");
  require(deviation.allFinite() && deviation.minCoeff() > 0.0,
          "smoother: a deviation is not positive");
  const Eigen::VectorXd inverse = deviation.cwiseInverse();
  scaled_ = inverse.asDiagonal() * kernel * inverse.asDiagonal();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd(inverse.asDiagonal() * trend));
  const Eigen::MatrixXd q = qr.householderQ();
  free_ = q.leftCols(p);
  triangle_ = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  const Eigen::VectorXd pivots = triangle_.diagonal().cwiseAbs();
  require(pivots.minCoeff() > kRankLost * pivots.maxCoeff(),
          "smoother: the places do not determine the free part");
  decompose(q.rightCols(n - p));
  foretold_ = directions_.cwiseAbs2().rowwise().sum().array() > kAlone;
}

void Smoother::decompose(const Eigen::MatrixXd& rest) {
  if (rest.cols() == 0) {
    directions_ = rest;
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      finite(Eigen::MatrixXd(rest.transpose() * scaled_ * rest), "smoother: kernel"));
  if (eigen.info() != Eigen::Success) {
    throw NumericalFailure("smoother: the kernel has no eigen-decomposition");
  }
  directions_ = rest * eigen.eigenvectors();
  eigenvalue_ = eigen.eigenvalues();
  const double largest = std::max(eigenvalue_.maxCoeff(), 0.0);
  // Rounding errors of a kernel that lies mostly in the free part.
  const double rounding = kRounding * scaled_.norm();
  if (eigenvalue_.minCoeff() < -kIndefinite * largest - rounding) {
    throw NumericalFailure("smoother: the kernel is not positive semidefinite, one eigenvalue is " +
                           fmt::format("{:.6g}", eigenvalue_.minCoeff() / largest) +
                           " of the largest");
  }
  eigenvalue_ = (eigenvalue_.array() > kNoEnergy * largest + rounding).select(eigenvalue_, 0.0);
}

Eigen::ArrayXd Smoother::contrasts(const Eigen::VectorXd& values) const {
  require(values.size() == deviation_.size(), "smoother: " + fmt::to_string(values.size()) +
                                                  " values, expected " +
                                                  fmt::to_string(deviation_.size()));
  return directions_.transpose() * values.cwiseQuotient(deviation_);
}

Eigen::ArrayXd Smoother::shrinkage(double lambda) const {
  return 1.0 / (1.0 + eigenvalue_.array() / lambda);
}

Smoother::Criterion Smoother::cross_validation(const Eigen::ArrayXd& z,
                                               const Eigen::ArrayXd& h) const {
  const Eigen::ArrayXd change = h * (1.0 - h);
  const Eigen::MatrixXd squares = directions_.cwiseAbs2();
  const Eigen::ArrayXd left = directions_ * (h * z).matrix();
  const Eigen::ArrayXd left_change = directions_ * (change * z).matrix();
  const Eigen::ArrayXd share = squares * h.matrix();  // 1 − A_mm
  const Eigen::ArrayXd share_change = squares * change.matrix();
  const Eigen::ArrayXd error = foretold_.select(left / share, 0.0);
  const Eigen::ArrayXd slope = 2.0 * error * (left_change - error * share_change) / share;
  return {error.square().sum(), foretold_.select(slope, 0.0).sum()};
}

Smoother::Criterion Smoother::criterion(const Eigen::VectorXd& values, SmoothingRule rule,
                                        double noise, double lambda) const {
  const Eigen::ArrayXd z = contrasts(values);
  const Eigen::ArrayXd h = shrinkage(lambda);
  switch (rule) {
    case SmoothingRule::reml_known_noise:
      return likelihood(z, h, noise);
    case SmoothingRule::reml:
      return profiled_likelihood(z, h);
    case SmoothingRule::leave_one_out:
      return cross_validation(z, h);
    case SmoothingRule::generalised_cross_validation:
      break;
  }
  const double share = h.sum() / static_cast<double>(deviation_.size());  // 1 − tr A / n
  const double share_slope = (h * (1.0 - h)).sum() / static_cast<double>(deviation_.size());
  const double squares = (z * h).square().sum();
  const double slope = 2.0 * ((z * h).square() * (1.0 - h)).sum();
  return {squares / (share * share),
          (slope - 2.0 * squares * share_slope / share) / (share * share)};
}

Smoothing Smoother::given(const Eigen::VectorXd& values, double lambda, double noise) const {
  require(lambda > 0.0 && noise > 0.0, "smoother: lambda or the noise is not positive");
  const double likelihood_there =
      -criterion(values, SmoothingRule::reml_known_noise, noise, lambda).value;
  return {lambda, noise, likelihood_there, false};
}

Smoother::Lowest Smoother::lowest(const Eigen::VectorXd& values, SmoothingRule rule, double noise,
                                  double loudness) const {
  const double largest = eigenvalue_.maxCoeff();
  const double smallest = (eigenvalue_.array() > 0.0).select(eigenvalue_, largest).minCoeff();
  const double low = std::log(1e-6 * smallest / (1.0 + loudness));
  const double high = std::log(1e6 * largest);
  const int count = static_cast<int>(
      std::ceil((high - low) / std::numbers::ln10 * Constants::smoothing_per_decade));
  const auto at = [&](double log_lambda) {
    return criterion(values, rule, noise, std::exp(log_lambda));
  };
  const auto best = minimum_in([&](double x) { return at(x).value; },
                               [&](double x) { return at(x).slope; }, low, high, count);
  return {best.at_high ? kFlat : std::exp(best.at), best.at_low};
}

Smoothing Smoother::chosen(const Eigen::VectorXd& values, SmoothingRule rule, double noise) const {
  require(noise > 0.0, "smoother: the noise is not positive");
  const Eigen::ArrayXd z = contrasts(values);
  const double squares = z.square().sum();
  const double all = values.cwiseQuotient(deviation_).squaredNorm();
  const bool bends = contrast_count() > 0 && eigenvalue_.maxCoeff() > 0.0;
  if (!bends || squares <= kNothingLeft * all) return given(values, kFlat, noise);

  if (contrast_count() == 1 || !foretold_.any()) rule = SmoothingRule::reml_known_noise;
  const bool known = rule == SmoothingRule::reml_known_noise;
  const auto found = lowest(values, rule, noise, known ? squares / (noise * noise) : 0.0);
  const Eigen::ArrayXd h = shrinkage(found.lambda);
  if (rule == SmoothingRule::reml) {
    noise = std::sqrt((z.square() * h).mean());
  } else if (!known) {
    noise = std::max(noise, std::sqrt((z * h).square().sum() / h.sum()));
  }
  auto smoothing = given(values, found.lambda, noise);
  smoothing.interpolates = found.at_lower_bound;
  return smoothing;
}

SmoothFunction Smoother::fit(const Eigen::VectorXd& values, double lambda) const {
  const Eigen::ArrayXd z = contrasts(values);
  const Eigen::VectorXd bend = directions_ * (z / (eigenvalue_.array() + lambda)).matrix();
  const Eigen::VectorXd rest = values.cwiseQuotient(deviation_) - scaled_ * bend;
  return {bend.cwiseQuotient(deviation_),
          triangle_.triangularView<Eigen::Upper>().solve(free_.transpose() * rest)};
}

Eigen::VectorXd Smoother::left_out_errors(const Eigen::VectorXd& values, double lambda) const {
  const Eigen::ArrayXd h = shrinkage(lambda);
  const Eigen::VectorXd left = directions_ * (h * contrasts(values)).matrix();
  const Eigen::VectorXd share = directions_.cwiseAbs2() * h.matrix();
  return foretold_.select((left.cwiseQuotient(share).cwiseProduct(deviation_)).array(),
                          std::numeric_limits<double>::quiet_NaN());
}

Eigen::VectorXd Smoother::influence(double lambda) const {
  return (1.0 - (directions_.cwiseAbs2() * shrinkage(lambda).matrix()).array()).matrix();
}

Eigen::MatrixXd Smoother::variance(const Eigen::MatrixXd& kernel, const Eigen::VectorXd& self,
                                   const Eigen::MatrixXd& trend,
                                   const std::vector<Smoothing>& smoothings) const {
  // w are the weights on the values that give the free part. f(x) − wᵀy does not depend on this
  // part, so the contrasts determine it.
  const Eigen::MatrixXd a =
      triangle_.triangularView<Eigen::Upper>().solve<Eigen::OnTheRight>(trend);
  const Eigen::MatrixXd rows = kernel * deviation_.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd image = scaled_ * free_;  // n×p
  const Eigen::MatrixXd both = a * free_.transpose();
  const Eigen::VectorXd unseen = self - 2.0 * both.cwiseProduct(rows).rowwise().sum() +
                                 (a * (free_.transpose() * image)).cwiseProduct(a).rowwise().sum();
  const Eigen::MatrixXd seen = ((rows - a * image.transpose()) * directions_).cwiseAbs2();
  Eigen::MatrixXd variance(kernel.rows(), static_cast<Eigen::Index>(smoothings.size()));
  for (std::size_t i = 0; i < smoothings.size(); ++i) {
    const auto& s = smoothings[i];
    const Eigen::VectorXd gain = (eigenvalue_.array() + s.lambda).inverse();
    const Eigen::ArrayXd bend = ((unseen - seen * gain) / s.lambda).array().max(0.0);
    variance.col(static_cast<Eigen::Index>(i)) =
        s.noise * s.noise * (bend + a.rowwise().squaredNorm().array());
  }
  return variance;
}

}  // namespace chladni::priors
