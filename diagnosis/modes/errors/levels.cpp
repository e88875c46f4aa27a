#include "diagnosis/modes/errors/levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "dense/algebra.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array<std::string_view, kErrorClasses> kNames{
    "frequency", "damping", "shape", "phase", "residue", "gain", "place", "field", "smooth_shape"};

// Variance of the own error of number i.
double own_variance(const ModeBlock& block, Index i, const PerClass& levels) {
  const int of = block.of[at(i)];
  return of < 0 ? 0.0 : std::pow(block.weight[at(i)] * levels(of), 2);
}

MatrixXd scaled(const MatrixXd& shared, const std::vector<int>& of, const PerClass& levels) {
  MatrixXd result = shared;
  for (Index c = 0; c < result.cols(); ++c) {
    if (of[at(c)] >= 0) result.col(c) *= levels(of[at(c)]);
  }
  return result;
}

// Lower triangle of the covariance that the numbers of a block have by themselves.
MatrixXd own_covariance(const ModeBlock& block, const PerClass& levels) {
  MatrixXd own = block.noise.cwiseAbs2().asDiagonal();
  for (Index i = 0; i < block.count(); ++i) own(i, i) += own_variance(block, i, levels);
  auto lower = own.selfadjointView<Eigen::Lower>();
  const double s = levels(static_cast<int>(ErrorClass::frequency));
  if (block.free.cols() > 0) lower.rankUpdate(block.free);
  if (block.mixed.cols() > 0) lower.rankUpdate(block.mixed, s * s);
  if (block.smooth.cols() > 0) lower.rankUpdate(scaled(block.smooth, block.smooth_of, levels));
  return own;
}

// Its Cholesky factor.
MatrixXd own_factor(const ModeBlock& block, const PerClass& levels) {
  return covariance_factor(own_covariance(block, levels));
}

double log_determinant_of(const MatrixXd& factor) {
  return 2.0 * factor.diagonal().array().log().sum();
}

// Sums over blocks whose errors their own factors have made white.
struct WhiteSums {
  MatrixXd gram;    // k×k, lower triangle: 1 + sharedᵀ shared
  VectorXd shared;  // k: sharedᵀ error
  double square = 0.0, log_determinant = 0.0;
  Index count = 0;

  void add(const ModeBlock& block, const MatrixXd& factor,
           const Eigen::Ref<const MatrixXd>& shared_errors) {
    const VectorXd white = factor.triangularView<Eigen::Lower>().solve(block.error);
    shared += shared_errors.transpose() * white;
    square += white.squaredNorm();
    log_determinant += log_determinant_of(factor);
    count += white.size();
  }

  [[nodiscard]] double negative_log() && {
    if (!dense::cholesky(gram)) throw NumericalFailure("modal data: errors without bounds");
    const VectorXd explained = gram.triangularView<Eigen::Lower>().solve(shared);
    return 0.5 * (square - explained.squaredNorm() + log_determinant + log_determinant_of(gram) +
                  static_cast<double>(count) * std::log(2.0 * std::numbers::pi));
  }
};

}  // namespace

std::string_view name(ErrorClass of) { return kNames[static_cast<std::size_t>(of)]; }

MatrixXd covariance_factor(MatrixXd covariance) {
  if (!dense::cholesky(covariance)) {
    throw NumericalFailure("modal data: a covariance that is not positive");
  }
  return covariance;
}

MatrixXd covariance_of(const ModeBlock& block, const std::vector<int>& shared_of,
                       const PerClass& levels) {
  MatrixXd all = own_covariance(block, levels);
  auto lower = all.selfadjointView<Eigen::Lower>();
  if (block.shared.cols() > 0) lower.rankUpdate(scaled(block.shared, shared_of, levels));
  return lower;
}

Index numbers(const ModeErrors& errors) {
  Index n = 0;
  for (const auto& block : errors.blocks) n += block.count();
  return n;
}

VectorXd stacked(const ModeErrors& errors) {
  VectorXd all(numbers(errors));
  Index first = 0;
  for (const auto& block : errors.blocks) {
    all.segment(first, block.count()) = block.error;
    first += block.count();
  }
  return all;
}

LevelLikelihood::LevelLikelihood(ModeErrors given, const PerClass& levels)
    : errors_(std::move(given)), levels_(levels) {
  const auto k = static_cast<Index>(errors_.shared_of.size());
  shared_.resize(numbers(errors_), k);
  gram_ = MatrixXd::Identity(k, k);
  for (const auto& block : errors_.blocks) {
    first_.push_back(first_.empty() ? 0 : first_.back() + factor_.back().rows());
    factor_.push_back(own_factor(block, levels));
    log_determinant_ += log_determinant_of(factor_.back());
    if (k == 0) continue;
    const MatrixXd shared = shared_of(block, factor_.back());
    dense::add_gram(shared, gram_);
    shared_.middleRows(first_.back(), block.count()) = shared;
  }
  error_ = whitened(stacked(errors_));
  capacitance_ = gram_;
  if (!dense::cholesky(capacitance_)) {
    throw NumericalFailure("modal data: errors without bounds");
  }
  log_determinant_ += log_determinant_of(capacitance_);
}

MatrixXd LevelLikelihood::shared_of(const ModeBlock& block, const MatrixXd& factor) const {
  MatrixXd shared = scaled(block.shared, errors_.shared_of, levels_);
  dense::solve(factor, shared);
  return shared;
}

MatrixXd LevelLikelihood::whitened(MatrixXd columns) const {
  for (std::size_t b = 0; b < factor_.size(); ++b) {
    auto rows = columns.middleRows(first_[b], factor_[b].rows());
    factor_[b].triangularView<Eigen::Lower>().solveInPlace(rows);
  }
  return columns;
}

MatrixXd LevelLikelihood::product(const MatrixXd& a, const MatrixXd& b) const {
  const MatrixXd left = whitened(a);
  const MatrixXd right = whitened(b);
  const auto lower = capacitance_.triangularView<Eigen::Lower>();
  const MatrixXd shared_left = lower.solve(shared_.transpose() * left);
  const MatrixXd shared_right = lower.solve(shared_.transpose() * right);
  return left.transpose() * right - shared_left.transpose() * shared_right;
}

VectorXd LevelLikelihood::squares(const MatrixXd& columns) const {
  const MatrixXd white = whitened(columns);
  const MatrixXd shared =
      capacitance_.triangularView<Eigen::Lower>().solve(MatrixXd(shared_.transpose() * white));
  return (white.colwise().squaredNorm() - shared.colwise().squaredNorm()).transpose();
}

double LevelLikelihood::negative_log(double square) const {
  return 0.5 * (square + log_determinant_ +
                static_cast<double>(error_.size()) * std::log(2.0 * std::numbers::pi)) +
         errors_.penalty;
}

double LevelLikelihood::negative_log(const VectorXd& stacked) const {
  return negative_log(squares(stacked)(0));
}

double LevelLikelihood::negative_log(const ModeErrors& other, const std::vector<bool>& kept) const {
  WhiteSums sums{gram_, VectorXd::Zero(gram_.rows())};
  for (std::size_t b = 0; b < kept.size(); ++b) {
    const auto& block = other.blocks[b];
    const auto here = shared_.middleRows(first_[b], factor_[b].rows());
    if (kept[b]) {
      sums.add(block, factor_[b], here);
      continue;
    }
    const MatrixXd factor = own_factor(block, levels_);
    const MatrixXd shared = shared_of(block, factor);
    dense::add_square(here.transpose(), -1.0, sums.gram);
    dense::add_gram(shared, sums.gram);
    sums.add(block, factor, shared);
  }
  return std::move(sums).negative_log() + other.penalty;
}

double LevelLikelihood::negative_log() const { return negative_log(stacked(errors_)); }

VectorXd LevelLikelihood::shared_means() const {
  const auto lower = capacitance_.triangularView<Eigen::Lower>();
  return lower.transpose().solve(VectorXd(lower.solve(VectorXd(shared_.transpose() * error_))));
}

VectorXd LevelLikelihood::block_squares() const {
  const VectorXd left = error_ - shared_ * shared_means();
  VectorXd squares(static_cast<Index>(first_.size()));
  for (std::size_t b = 0; b < first_.size(); ++b) {
    squares(static_cast<Index>(b)) = left.segment(first_[b], factor_[b].rows()).squaredNorm();
  }
  return squares;
}

LevelLikelihood::Evidence LevelLikelihood::evidence() const {
  Evidence result{PerClass::Zero(), PerClass::Zero()};
  const auto lower = capacitance_.triangularView<Eigen::Lower>();
  const MatrixXd spread = lower.solve(shared_.transpose());  // k×N
  const VectorXd shared_mean = shared_means();
  const VectorXd left = error_ - shared_ * shared_mean;
  Index first = 0;
  for (std::size_t b = 0; b < factor_.size(); ++b) {
    const auto& block = errors_.blocks[b];
    const Index n = block.count();
    const MatrixXd inverse =
        factor_[b].triangularView<Eigen::Lower>().solve(MatrixXd::Identity(n, n));
    const VectorXd weighted = inverse.transpose() * left.segment(first, n);
    const MatrixXd known = spread.middleCols(first, n) * inverse;
    for (Index i = 0; i < n; ++i) {
      const int of = block.of[at(i)];
      if (of < 0) continue;
      const double square = own_variance(block, i, levels_);
      result.size(of) += square * weighted(i) * weighted(i);
      result.determined(of) += square * (inverse.col(i).squaredNorm() - known.col(i).squaredNorm());
    }
    for (Index c = 0; c < block.smooth.cols(); ++c) {
      const int of = block.smooth_of[at(c)];
      const double square = levels_(of) * levels_(of);
      const VectorXd column = block.smooth.col(c);
      result.size(of) += square * std::pow(column.dot(weighted), 2);
      result.determined(of) +=
          square * ((inverse * column).squaredNorm() -
                    (spread.middleCols(first, n) * (inverse * column)).squaredNorm());
    }
    first += n;
  }
  const Index k = capacitance_.rows();
  const MatrixXd inverse = lower.solve(MatrixXd::Identity(k, k));
  for (Index c = 0; c < k; ++c) {
    const int of = errors_.shared_of[at(c)];
    if (of < 0) continue;
    result.size(of) += shared_mean(c) * shared_mean(c);
    result.determined(of) += 1.0 - inverse.col(c).squaredNorm();
  }
  return result;
}

// Newton's step in ln s on −½ (γ − Σ η²/s²) with the prior. 2 Σ η²/s² is replaced by its expected
// value 2 γ where it is smaller, so that the step is never too long.
PerClass updated(const PerClass& levels, const LevelPrior& prior,
                 const LevelLikelihood::Evidence& evidence) {
  if (prior.width <= 0.0) return levels;
  const double precision = 1.0 / (prior.width * prior.width);
  const PerClass off = (levels / prior.usual).log();
  const PerClass slope = evidence.determined - evidence.size + precision * off;
  const PerClass curvature = 2.0 * evidence.determined.max(evidence.size) + precision;
  const PerClass step = (-slope / curvature).max(-1.0).min(1.0);
  return (levels * step.exp()).min(prior.at_most);
}

double negative_log_prior(const PerClass& levels, const LevelPrior& prior,
                          const LevelLikelihood::Evidence& evidence) {
  if (prior.width <= 0.0) return 0.0;
  const double precision = 1.0 / (prior.width * prior.width);
  const PerClass off = (levels / prior.usual).log();
  const PerClass curvature = 2.0 * evidence.determined.max(0.0) + precision;
  return (0.5 * precision * off.square() + 0.5 * (curvature / precision).log()).sum();
}

LevelPrior level_prior(const Tolerances& tolerances, bool learned) {
  const auto least = [&](double tolerance, double floor) {
    return learned ? std::max(tolerance, floor) : tolerance;
  };
  LevelPrior prior;
  prior.usual << least(tolerances.frequency, 3e-3), least(tolerances.damping, 0.1),
      least(tolerances.response, 0.02), least(tolerances.response, 0.02),
      least(tolerances.response, 0.03), least(tolerances.gain, 5e-3),
      least(tolerances.position, 5e-4), least(tolerances.thickness, 1.5e-3),
      least(tolerances.response, 0.02);
  prior.at_most << 0.1, 1.5, 0.5, 0.5, 0.7, 0.3, 0.02, 0.05, 0.5;
  prior.at_most = prior.at_most.max(prior.usual);
  if (learned) prior.width = std::log(4.0);
  return prior;
}

}  // namespace chladni::diagnosis
