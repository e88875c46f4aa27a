#include "priors/residual/random_coefficients.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/finite.h"
#include "base/search.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

constexpr double kNegligible = 1e-13;  // of the largest squared singular value

}  // namespace

RandomCoefficients::RandomCoefficients(const Eigen::MatrixXd& weighted,
                                       const Eigen::VectorXd& values, const Eigen::VectorXd& noise)
    : noise_(noise) {
  require(weighted.rows() == values.size() && noise.size() == values.size() && values.size() > 0,
          "random coefficients: functions, values and noise do not fit together");
  require(noise.minCoeff() > 0.0, "random coefficients: the noise must be more than 0");
  const Eigen::VectorXd weight = noise.cwiseInverse();
  whitened_ = weight.asDiagonal() * weighted;
  values_ = values.cwiseProduct(weight);
  decompose();
  find_amplitude();
}

void RandomCoefficients::decompose() {
  const bool wide = whitened_.rows() <= whitened_.cols();
  const Eigen::MatrixXd gram = wide ? Eigen::MatrixXd(whitened_ * whitened_.transpose())
                                    : Eigen::MatrixXd(whitened_.transpose() * whitened_);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(gram, "random coefficients: products of the functions"));
  if (solver.info() != Eigen::Success) {
    throw NumericalFailure("random coefficients: the functions have no finite decomposition");
  }
  const Eigen::Index p = gram.rows();
  const double least = kNegligible * std::max(solver.eigenvalues()(p - 1), 0.0);
  Eigen::Index dropped = 0;
  while (dropped < p && solver.eigenvalues()(dropped) <= least) ++dropped;
  strength_ = solver.eigenvalues().tail(p - dropped);
  directions_ = solver.eigenvectors().rightCols(p - dropped);
  if (!wide) {
    directions_ = whitened_ * directions_ * strength_.cwiseSqrt().cwiseInverse().asDiagonal();
  }
  along_ = directions_.transpose() * values_;
  rest_ = std::max(values_.squaredNorm() - along_.squaredNorm(), 0.0);
}

double RandomCoefficients::log_evidence_at(double log_square) const {
  const Eigen::ArrayXd total = 1.0 + std::exp(log_square) * strength_.array();
  const double quadratic = (along_.array().square() / total).sum() + rest_;
  const double determinant = total.log().sum() + 2.0 * noise_.array().log().sum();
  return -0.5 * (determinant + quadratic +
                 static_cast<double>(values_.size()) * std::log(2.0 * std::numbers::pi));
}

double RandomCoefficients::slope_at(double log_square) const {
  const Eigen::ArrayXd part = std::exp(log_square) * strength_.array();
  return 0.5 * (along_.array().square() * part / (1.0 + part).square() - part / (1.0 + part)).sum();
}

void RandomCoefficients::find_amplitude() {
  const double signal = along_.squaredNorm() / std::max(strength_.sum(), 1e-300);
  const double middle = std::log(std::max(signal, 1e-300));
  const auto best =
      minimum_in([&](double at) { return -log_evidence_at(at); },
                 [&](double at) { return -slope_at(at); }, middle - Constants::amplitude_reach,
                 middle + Constants::amplitude_reach, Constants::amplitude_intervals);
  vanishes_ = best.at <= middle + Constants::vanishing;
  square_ = std::exp(best.at);
  log_evidence_ = -best.value;
}

Eigen::VectorXd RandomCoefficients::solved(const Eigen::VectorXd& whitened) const {
  return whitened - directions_ * damping().cwiseProduct(directions_.transpose() * whitened);
}

// Part of each direction that the prior explains: 0 none, 1 all.
Eigen::VectorXd RandomCoefficients::damping() const {
  const Eigen::ArrayXd part = square_ * strength_.array();
  return part / (1.0 + part);
}

Eigen::VectorXd RandomCoefficients::inverse_diagonal() const {
  return Eigen::VectorXd::Ones(values_.size()) - directions_.cwiseAbs2() * damping();
}

Eigen::VectorXd RandomCoefficients::variance_slopes() const {
  const Eigen::VectorXd pull = whitened_.transpose() * solved(values_);
  const Eigen::MatrixXd seen = directions_.transpose() * whitened_;
  const Eigen::VectorXd squared = whitened_.colwise().squaredNorm();
  const Eigen::VectorXd quadratic = squared - seen.cwiseAbs2().transpose() * damping();
  return 0.5 * square_ * (pull.cwiseAbs2() - quadratic);
}

Eigen::MatrixXd RandomCoefficients::covariance_slopes(const Eigen::MatrixXd& functions) const {
  const Eigen::MatrixXd whitened = noise_.cwiseInverse().asDiagonal() * functions;
  const Eigen::VectorXd pull = whitened.transpose() * solved(values_);
  const Eigen::MatrixXd seen = directions_.transpose() * whitened;
  return 0.5 * square_ *
         (pull * pull.transpose() - whitened.transpose() * whitened +
          seen.transpose() * damping().asDiagonal() * seen);
}

Eigen::VectorXd RandomCoefficients::noise_slopes() const {
  return solved(values_).cwiseAbs2() - inverse_diagonal();
}

Eigen::VectorXd RandomCoefficients::mean() const {
  return square_ * (whitened_.transpose() * solved(values_));
}

RandomCoefficients::Posterior RandomCoefficients::posterior() const {
  const Eigen::Index k = whitened_.cols();
  Eigen::MatrixXd precision = whitened_.transpose() * whitened_;
  precision.diagonal().array() += 1.0 / square_;
  const Eigen::LLT<Eigen::MatrixXd> factor(precision);
  if (factor.info() != Eigen::Success) {
    throw NumericalFailure("random coefficients: the posterior is not positive definite");
  }
  Posterior known;
  known.mean = factor.solve(Eigen::VectorXd(whitened_.transpose() * values_));
  known.root = factor.matrixU().solve(Eigen::MatrixXd::Identity(k, k));
  return known;
}

RandomCoefficients::LeftOut RandomCoefficients::left_out() const {
  const Eigen::ArrayXd inverse = inverse_diagonal().cwiseMax(1e-300);
  LeftOut result;
  result.standardised = (solved(values_).array() / inverse.sqrt()).matrix();
  const Eigen::ArrayXd log_deviation = noise_.array().log() - 0.5 * inverse.log();
  result.log_density = -(log_deviation + 0.5 * result.standardised.array().square() +
                         0.5 * std::log(2.0 * std::numbers::pi))
                            .sum();
  return result;
}

}  // namespace chladni::priors
