#include "diagnosis/modes/errors/levels.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/index.h"

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

MatrixXd own_covariance(const ModeBlock& block, const PerClass& levels) {
  MatrixXd own = block.noise.cwiseAbs2().asDiagonal();
  for (Index i = 0; i < block.count(); ++i) own(i, i) += own_variance(block, i, levels);
  own += block.free * block.free.transpose();
  const double s = levels(static_cast<int>(ErrorClass::frequency));
  own += s * s * block.mixed * block.mixed.transpose();
  if (block.smooth.cols() > 0) {
    const MatrixXd smooth = scaled(block.smooth, block.smooth_of, levels);
    own += smooth * smooth.transpose();
  }
  return own;
}

Index total(const ModeErrors& errors) {
  Index n = 0;
  for (const auto& block : errors.blocks) n += block.count();
  return n;
}

}  // namespace

std::string_view name(ErrorClass of) { return kNames[static_cast<std::size_t>(of)]; }

VectorXd stacked(const ModeErrors& errors) {
  VectorXd all(total(errors));
  Index first = 0;
  for (const auto& block : errors.blocks) {
    all.segment(first, block.count()) = block.error;
    first += block.count();
  }
  return all;
}

LevelLikelihood::LevelLikelihood(ModeErrors given, const PerClass& levels)
    : errors_(std::move(given)), levels_(levels) {
  const ModeErrors& errors = errors_;
  const Index n = total(errors);
  const auto k = static_cast<Index>(errors.shared_of.size());
  MatrixXd shared(n, k);
  Index first = 0;
  for (const auto& block : errors.blocks) {
    const Eigen::LLT<MatrixXd> factor(own_covariance(block, levels));
    if (factor.info() != Eigen::Success) {
      throw NumericalFailure("modal data: a covariance that is not positive");
    }
    factor_.emplace_back(factor.matrixL());
    log_determinant_ += 2.0 * factor_.back().diagonal().array().log().sum();
    if (k > 0) shared.middleRows(first, block.count()) = block.shared;
    first += block.count();
  }
  shared_ = whitened(scaled(shared, errors.shared_of, levels));
  error_ = whitened(stacked(errors));
  const MatrixXd gram = MatrixXd::Identity(k, k) + shared_.transpose() * shared_;
  capacitance_ = Eigen::LLT<MatrixXd>(gram).matrixL();
  if (k > 0) log_determinant_ += 2.0 * capacitance_.diagonal().array().log().sum();
}

MatrixXd LevelLikelihood::whitened(MatrixXd columns) const {
  Index first = 0;
  for (const auto& factor : factor_) {
    auto rows = columns.middleRows(first, factor.rows());
    factor.triangularView<Eigen::Lower>().solveInPlace(rows);
    first += factor.rows();
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

double LevelLikelihood::negative_log(const VectorXd& stacked) const {
  const VectorXd white = whitened(stacked);
  const VectorXd shared =
      capacitance_.triangularView<Eigen::Lower>().solve(VectorXd(shared_.transpose() * white));
  const double square = white.squaredNorm() - shared.squaredNorm();
  return 0.5 * (square + log_determinant_ +
                static_cast<double>(white.size()) * std::log(2.0 * std::numbers::pi)) +
         errors_.penalty;
}

double LevelLikelihood::negative_log() const { return negative_log(stacked(errors_)); }

LevelLikelihood::Evidence LevelLikelihood::evidence() const {
  Evidence result{PerClass::Zero(), PerClass::Zero()};
  const auto lower = capacitance_.triangularView<Eigen::Lower>();
  const MatrixXd spread = lower.solve(shared_.transpose());  // k×N
  const VectorXd shared_mean =
      lower.transpose().solve(VectorXd(lower.solve(VectorXd(shared_.transpose() * error_))));
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
