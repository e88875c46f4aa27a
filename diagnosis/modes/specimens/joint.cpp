#include "diagnosis/modes/specimens/joint.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "dense/algebra.h"
#include "diagnosis/modes/specimens/specimen_constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr Index kShared = 0, kOwn = 1, kFirstSpread = 2;
constexpr int kScoringSteps = 40;

MatrixXd outer(const MatrixXd& columns) { return columns * columns.transpose(); }

// 1 where two numbers are of one mode of the design; `of_body`: and of one body.
MatrixXd same_mode(const Series& series, bool of_body) {
  const Index n = series.count();
  MatrixXd same = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const auto& a = series.rows[at(i)];
      const auto& b = series.rows[at(j)];
      if (a.mode < 0 || a.mode != b.mode) continue;
      if (!of_body || a.body == b.body) same(i, j) = 1.0;
    }
  }
  return same;
}

MatrixXd in_one_group(const Series& series) {
  const Index b = series.body_count();
  MatrixXd same(b, b);
  for (Index i = 0; i < b; ++i) {
    for (Index j = 0; j < b; ++j)
      same(i, j) = series.group[at(i)] == series.group[at(j)] ? 1.0 : 0.0;
  }
  return same;
}

MatrixXd known_part(const Series& series) {
  MatrixXd known =
      (series.noise.array().square() + kSpecimens.least_variance).matrix().asDiagonal();
  const VectorXd each = VectorXd::Ones(series.body_count());
  for (const auto& one : series.constants) known += outer(one.width * (one.slope * each));
  for (const auto& one : series.entries) known += outer(one.stated.deviation * one.slope);
  return known;
}

}  // namespace

// Objective at some levels, and what a step of Fisher's scoring needs.
struct JointModel::Scored {
  double value = HUGE_VAL;  // −ln of likelihood and prior, without constants
  Eigen::LLT<MatrixXd> factor;
  VectorXd weighted, gradient;
  MatrixXd inverse, information;
};

JointModel::JointModel(const Series& series, bool learned) : series_(series) {
  const auto c = static_cast<Index>(series.constants.size());
  const Index levels = kFirstSpread + c + (series.has_groups ? 1 : 0);
  usual_.resize(levels);
  width_ = VectorXd::Constant(levels, kSpecimens.spread_width);
  at_most_ = VectorXd::Zero(levels);  // a factor of e
  usual_(kShared) = std::log(kSpecimens.shared_error);
  usual_(kOwn) = std::log(kSpecimens.own_error);
  width_.head(kFirstSpread).setConstant(kSpecimens.error_width);
  at_most_.head(kFirstSpread).setConstant(std::log(kSpecimens.error_at_most));
  for (Index i = 0; i < c; ++i) {
    const auto& one = series.constants[at(i)];
    usual_(kFirstSpread + i) = std::log(std::min(kSpecimens.spread, 0.5 * one.width));
    group_.push_back(MatrixXd());
    body_.push_back(outer(one.slope));
  }
  if (series.has_groups) {
    usual_(levels - 1) = std::log(kSpecimens.within_group);
    width_(levels - 1) = kSpecimens.within_group_width;
  }
  if (!learned) width_.head(kFirstSpread).setConstant(1e-3);
  same_group_ = in_one_group(series);
  for (Index i = 0; series.has_groups && i < c; ++i) {
    const auto& slope = series.constants[at(i)].slope;
    group_[at(i)] = slope * same_group_ * slope.transpose();
  }
  known_ = known_part(series);
  shared_ = same_mode(series, false);
  own_ = same_mode(series, true);
}

MatrixXd JointModel::columns(const Supposition& supposed) const {
  const Index n = series_.count();
  MatrixXd all(n, 0);
  const auto add = [&](const VectorXd& column) {
    all.conservativeResize(n, all.cols() + 1);
    all.rightCols(1) = column;
  };
  for (const Index e : supposed.entries) add(kSpecimens.blunder * series_.entries[at(e)].slope);
  if (supposed.unlike < 0) return all;
  if (!supposed.by_modes) {
    for (const auto& one : series_.constants) {
      add(kSpecimens.unlike_constants * one.slope.col(supposed.unlike));
    }
    return all;
  }
  for (Index i = 0; i < n; ++i) {
    const auto& row = series_.rows[at(i)];
    if (row.body == supposed.unlike && row.mode >= 0) {
      add(kSpecimens.unlike_modes * VectorXd::Unit(n, i));
    }
  }
  return all;
}

MatrixXd JointModel::covariance(const VectorXd& ln_levels) const {
  const VectorXd variance = (2.0 * ln_levels).array().exp();
  MatrixXd all = known_ + variance(kShared) * shared_ + variance(kOwn) * own_;
  for (std::size_t c = 0; c < body_.size(); ++c) {
    const double of_constant = variance(kFirstSpread + static_cast<Index>(c));
    all += (series_.has_groups ? of_constant * variance(ratio_level()) : of_constant) * body_[c];
    if (series_.has_groups) all += of_constant * group_[c];
  }
  return all;
}

// dK / d ln(level).
MatrixXd JointModel::slope(const VectorXd& ln_levels, Index level) const {
  const VectorXd twice = 2.0 * (2.0 * ln_levels).array().exp();
  if (level == kShared) return twice(level) * shared_;
  if (level == kOwn) return twice(level) * own_;
  if (series_.has_groups && level == ratio_level()) {
    MatrixXd all = MatrixXd::Zero(series_.count(), series_.count());
    for (std::size_t c = 0; c < body_.size(); ++c) {
      all += 0.5 * twice(kFirstSpread + static_cast<Index>(c)) * twice(level) * body_[c];
    }
    return all;
  }
  const std::size_t c = at(level - kFirstSpread);
  if (!series_.has_groups) return twice(level) * body_[c];
  return twice(level) * (group_[c] + 0.5 * twice(ratio_level()) * body_[c]);
}

// @param more  the columns that a supposition adds, times their transpose
JointModel::Scored JointModel::scored(const MatrixXd& more, const VectorXd& x) const {
  Scored result;
  result.factor.compute(MatrixXd(covariance(x) + more));
  if (result.factor.info() != Eigen::Success) return result;
  const VectorXd off = (x - usual_).cwiseQuotient(width_);
  result.weighted = result.factor.solve(series_.error);
  result.value = 0.5 * series_.error.dot(result.weighted) +
                 result.factor.matrixLLT().diagonal().array().log().sum() + 0.5 * off.squaredNorm();
  return result;
}

// Adds the inverse, and gradient and Fisher's information of the objective at x.
void JointModel::add_slopes(const VectorXd& x, Scored& here) const {
  if (!std::isfinite(here.value)) return;
  here.inverse = dense::inverse_of(here.factor);
  std::vector<MatrixXd> parts;
  here.gradient = (x - usual_).cwiseQuotient(width_).cwiseQuotient(width_);
  for (Index j = 0; j < x.size(); ++j) {
    const MatrixXd d = slope(x, j);
    parts.emplace_back(here.inverse * d);
    here.gradient(j) += 0.5 * parts.back().trace() - 0.5 * here.weighted.dot(d * here.weighted);
  }
  here.information = width_.cwiseAbs2().cwiseInverse().asDiagonal();
  for (Index j = 0; j < x.size(); ++j) {
    for (Index k = 0; k <= j; ++k) {
      const double both = 0.5 * parts[at(j)].cwiseProduct(parts[at(k)].transpose()).sum();
      here.information(j, k) += both;
      if (k < j) here.information(k, j) += both;
    }
  }
}

JointFit JointModel::fitted(const Supposition& supposed, const VectorXd& start) const {
  const MatrixXd more = outer(columns(supposed));
  VectorXd x = start.size() == usual_.size() ? start : usual_;
  Scored here = scored(more, x);
  add_slopes(x, here);
  double damping = 1e-2;
  for (int step = 0; step < kScoringSteps && std::isfinite(here.value); ++step) {
    MatrixXd damped = here.information;
    damped.diagonal() *= 1.0 + damping;
    const VectorXd by = -damped.ldlt().solve(here.gradient);
    const VectorXd there = (x + by.cwiseMin(1.0).cwiseMax(-1.0)).cwiseMin(at_most_);
    Scored next = scored(more, there);
    const double fall = here.value - next.value;
    damping = fall > 0.0 ? 0.3 * damping : 8.0 * damping + 0.05;
    if (fall > 0.0) {
      x = there;
      here = std::move(next);
      add_slopes(x, here);
    }
    if (std::abs(fall) < 1e-4 || damping > 1e4) break;
  }
  if (!std::isfinite(here.value))
    throw NumericalFailure("specimens: a covariance that is not positive");
  const auto n = static_cast<double>(series_.count());
  JointFit fit{supposed, x, 0.0, here.weighted, here.inverse};
  fit.log_evidence = -here.value - 0.5 * n * std::log(2.0 * std::numbers::pi) -
                     width_.array().log().sum() -
                     here.information.llt().matrixLLT().diagonal().array().log().sum();
  return fit;
}

double JointModel::promise(const JointFit& fit, const Supposition& more) const {
  const MatrixXd add = columns(more);
  if (add.cols() == 0) return 0.0;
  MatrixXd inner = add.transpose() * fit.inverse * add;
  inner.diagonal().array() += 1.0;
  const VectorXd by = add.transpose() * fit.weighted;
  const Eigen::LLT<MatrixXd> factor(inner);
  return 0.5 * by.dot(factor.solve(by)) - factor.matrixLLT().diagonal().array().log().sum();
}

// Prior covariance of ln of a constant of the bodies.
MatrixXd JointModel::between_bodies(const VectorXd& ln_levels, std::size_t constant) const {
  const Index b = series_.body_count();
  const double of_constant = std::exp(2.0 * ln_levels(kFirstSpread + static_cast<Index>(constant)));
  MatrixXd all = MatrixXd::Constant(b, b, std::pow(series_.constants[constant].width, 2));
  if (!series_.has_groups) {
    all.diagonal().array() += of_constant;
    return all;
  }
  all += of_constant * same_group_;
  all.diagonal().array() += of_constant * std::exp(2.0 * ln_levels(ratio_level()));
  return all;
}

Posterior JointModel::constant(const JointFit& fit, std::size_t which) const {
  MatrixXd prior = between_bodies(fit.ln_levels, which);
  const auto& supposed = fit.supposed;
  if (supposed.unlike >= 0 && !supposed.by_modes) {
    prior(supposed.unlike, supposed.unlike) += std::pow(kSpecimens.unlike_constants, 2);
  }
  const MatrixXd with_data = prior * series_.constants[which].slope.transpose();
  return {with_data * fit.weighted, prior - with_data * fit.inverse * with_data.transpose()};
}

Vector2d JointModel::mean_of(const JointFit& fit, std::size_t which) const {
  const auto& one = series_.constants[which];
  const double prior = one.width * one.width;
  const VectorXd with_data = prior * one.slope.rowwise().sum();
  return {with_data.dot(fit.weighted), prior - with_data.dot(fit.inverse * with_data)};
}

Vector2d JointModel::entry(const JointFit& fit, std::size_t which) const {
  const auto& one = series_.entries[which];
  double prior = one.stated.deviation * one.stated.deviation;
  if (std::ranges::find(fit.supposed.entries, static_cast<Index>(which)) !=
      fit.supposed.entries.end()) {
    prior += kSpecimens.blunder * kSpecimens.blunder;
  }
  return {prior * one.slope.dot(fit.weighted),
          prior - prior * prior * one.slope.dot(fit.inverse * one.slope)};
}

VectorXd JointModel::shared_error(const JointFit& fit) const {
  return std::exp(2.0 * fit.ln_levels(kShared)) * (shared_ * fit.weighted);
}

double JointModel::spread(const JointFit& fit, std::size_t which) const {
  return std::exp(fit.ln_levels(kFirstSpread + static_cast<Index>(which)));
}

double JointModel::within_group(const JointFit& fit, std::size_t which) const {
  return series_.has_groups ? spread(fit, which) * std::exp(fit.ln_levels(ratio_level())) : 0.0;
}

}  // namespace chladni::diagnosis
