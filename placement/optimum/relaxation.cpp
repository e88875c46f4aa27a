#include "placement/optimum/relaxation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/interrupt.h"

namespace chladni::placement {
namespace {

using Indices = std::vector<Eigen::Index>;

double log_det(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

// The candidates of the working set, their weights and their information.
class WorkingSet {
 public:
  WorkingSet(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& base, Eigen::Index count)
      : all_(rows), base_(base), count_(static_cast<double>(count)) {}

  [[nodiscard]] const Indices& members() const { return members_; }
  [[nodiscard]] const Eigen::VectorXd& weights() const { return z_; }
  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] const Eigen::LLT<Eigen::MatrixXd>& factor() const { return factor_; }

  // The first members get equal shares; newcomers get a small part of all shares.
  void admit(const Indices& newcomers) {
    const auto before = z_.size();
    members_.insert(members_.end(), newcomers.begin(), newcomers.end());
    z_.conservativeResize(static_cast<Eigen::Index>(members_.size()));
    const double even = count_ / static_cast<double>(z_.size());
    if (before == 0) {
      z_.setConstant(even);
    } else {
      const double small = 0.02 * even;
      const double share = small * static_cast<double>(newcomers.size());
      z_.head(before) *= (count_ - share) / count_;
      z_.tail(z_.size() - before).setConstant(small);
    }
    rows_ = all_(members_, Eigen::all);
    refresh();
  }

  // One damped Newton step on value + mu Σ (log z + log(1 − z)); returns the Newton decrement.
  double step(double mu) {
    throw_if_interrupted();
    const Eigen::MatrixXd half = factor_.matrixL().solve(rows_.transpose());
    const Eigen::MatrixXd among = half.transpose() * half;
    const Eigen::ArrayXd z = z_.array();
    const Eigen::VectorXd slope =
        among.diagonal() + (mu * (z.inverse() - (1.0 - z).inverse())).matrix();
    Eigen::MatrixXd curvature = among.cwiseAbs2();
    curvature.diagonal() += (mu * (z.square().inverse() + (1.0 - z).square().inverse())).matrix();
    const Eigen::LLT<Eigen::MatrixXd> solver(curvature);
    const Eigen::VectorXd ahead = solver.solve(slope);
    const Eigen::VectorXd even = solver.solve(Eigen::VectorXd::Ones(z_.size()));
    const Eigen::VectorXd move = ahead - (ahead.sum() / even.sum()) * even;
    const double decrement = slope.dot(move);
    if (decrement > 0.0) walk(move, mu, decrement);
    return decrement;
  }

 private:
  void refresh() {
    factor_.compute(base_ + rows_.transpose() * z_.asDiagonal() * rows_);
    value_ = log_det(factor_);
  }

  [[nodiscard]] double merit(double mu) const {
    return value_ + mu * (z_.array().log() + (1.0 - z_.array()).log()).sum();
  }

  void walk(const Eigen::VectorXd& move, double mu, double decrement) {
    double length = 1.0;
    for (Eigen::Index i = 0; i < z_.size(); ++i) {
      const double room = move(i) > 0.0 ? 1.0 - z_(i) : z_(i);
      if (move(i) != 0.0) length = std::min(length, 0.98 * room / std::abs(move(i)));
    }
    const Eigen::VectorXd start = z_;
    const double before = merit(mu);
    for (int halving = 0; halving < 30; ++halving, length *= 0.5) {
      z_ = start + length * move;
      refresh();
      if (merit(mu) >= before + 0.01 * length * decrement) return;
    }
    z_ = start;
    refresh();
  }

  const Eigen::MatrixXd& all_;
  const Eigen::MatrixXd& base_;
  double count_;
  Indices members_;
  Eigen::MatrixXd rows_;
  Eigen::VectorXd z_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  double value_ = 0.0;
};

void optimise(WorkingSet& set, double tolerance, bool first) {
  const double size = static_cast<double>(set.members().size());
  const double least = tolerance / (4.0 * size);
  for (double mu = first ? 0.1 : 100.0 * least;; mu = std::max(0.05 * mu, least)) {
    for (int steps = 0; steps < 8; ++steps) {
      if (set.step(mu) < 0.5 * mu) break;
    }
    if (mu <= least) return;
  }
}

Indices largest(const Eigen::VectorXd& values, Eigen::Index count) {
  Indices order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::partial_sort(order.begin(), order.begin() + count, order.end(),
                    [&](Eigen::Index a, Eigen::Index b) {
                      return values(a) > values(b) || (values(a) == values(b) && a < b);
                    });
  order.resize(static_cast<std::size_t>(count));
  return order;
}

// The first members: those of largest gain, chosen one after the other, so that they differ.
Indices spread(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& base, Eigen::Index count) {
  const Eigen::LLT<Eigen::MatrixXd> factor(base);
  Eigen::MatrixXd left = factor.matrixL().solve(rows.transpose());
  Eigen::VectorXd gain = left.colwise().squaredNorm();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(rows.cols(), rows.cols());
  Indices chosen;
  std::vector<char> taken(static_cast<std::size_t>(rows.rows()), 0);
  while (static_cast<Eigen::Index>(chosen.size()) < count) {
    Eigen::Index best = -1;
    for (Eigen::Index c = 0; c < gain.size(); ++c) {
      if (taken[static_cast<std::size_t>(c)] == 0 && (best < 0 || gain(c) > gain(best))) best = c;
    }
    taken[static_cast<std::size_t>(best)] = 1;
    chosen.push_back(best);
    const Eigen::VectorXd seen = inverse * left.col(best);
    const double scale = 1.0 / (1.0 + gain(best));
    gain -= scale * (left.transpose() * seen).cwiseAbs2();
    gain = gain.cwiseMax(0.0);
    inverse -= scale * seen * seen.transpose();
  }
  return chosen;
}

void assess(const WorkingSet& set, const Eigen::MatrixXd& rows, Eigen::Index count,
            Relaxation& result) {
  result.gain = set.factor().matrixL().solve(rows.transpose()).colwise().squaredNorm();
  result.z = Eigen::VectorXd::Zero(rows.rows());
  result.z(set.members()) = set.weights();
  result.value = set.value();
  const Indices top = largest(result.gain, count);
  result.bound = result.value + result.gain(top).sum() - result.z.dot(result.gain);
}

}  // namespace

Relaxation relaxed(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& base, Eigen::Index count,
                   double give_up, double tolerance) {
  Relaxation result;
  const Eigen::Index n = rows.rows();
  WorkingSet set(rows, base, count);
  set.admit(spread(rows, base, std::min(n, std::max<Eigen::Index>(3 * count, count + 20))));
  for (int round = 0; round < 50; ++round) {
    if (static_cast<Eigen::Index>(set.members().size()) > count) {
      optimise(set, tolerance, round == 0);
    }
    assess(set, rows, count, result);
    if (result.bound < give_up || result.bound - result.value < 2.0 * tolerance) break;
    Eigen::VectorXd outside = result.gain;
    outside(set.members()).setConstant(-1.0);
    const double threshold = result.gain(largest(result.gain, count)).minCoeff();
    Indices newcomers;
    for (const auto c : largest(outside, std::min<Eigen::Index>(n, 30))) {
      if (outside(c) >= threshold - 1e-12) newcomers.push_back(c);
    }
    if (newcomers.empty()) break;
    set.admit(newcomers);
  }
  return result;
}

}  // namespace chladni::placement
