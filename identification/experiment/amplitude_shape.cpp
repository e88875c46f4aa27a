#include "identification/experiment/amplitude_shape.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "base/turn.h"

namespace chladni::identification {
namespace {

constexpr double kEvenShare = 0.1;
constexpr int kSteps = 120;
constexpr double kExponent =
    0.2;                         // 1/(p + 1) for the sum of the p-th powers, p = 4: no step too far
constexpr double kReach = 40.0;  // half bandwidths around a mode beyond which nothing tells of it
constexpr double kShifts[] = {-1.5, -0.75, 0.0, 0.75, 1.5};  // of simulation_error

/// A mode at a frequency where it may be, and the lines that tell of it.
struct Scenario {
  Eigen::Index mode = 0;
  Eigen::Index first = 0, count = 0;    // lines
  std::vector<Eigen::Matrix3d> weight;  // per line: information on ln ω, ln ζ and the amplitude
};

// Information of one line on (ln ω, ln ζ, ln a) of h = 1 / (s² + 2ζωs + ω²), for |a|² = 1.
Eigen::Matrix3d information(double hz, double mode_hz, double ratio) {
  const std::complex<double> s(0.0, kTwoPi * hz);
  const double omega = kTwoPi * mode_hz;
  const auto h = 1.0 / (s * s + 2.0 * ratio * omega * s + omega * omega);
  const Eigen::Vector3cd slope(-(2.0 * ratio * omega * s + 2.0 * omega * omega) * h * h,
                               -2.0 * ratio * omega * s * h * h, h);
  return 2.0 * (slope * slope.adjoint()).real();
}

std::vector<Scenario> scenarios_of(const ShapeProblem& problem) {
  std::vector<Scenario> scenarios;
  const double* begin = problem.line_hz.data();
  const double* end = begin + problem.line_hz.size();
  for (Eigen::Index m = 0; m < problem.frequency_hz.size(); ++m) {
    for (const double shift : kShifts) {
      if (problem.simulation_error == 0.0 && shift != 0.0) continue;
      const double hz = problem.frequency_hz(m) * (1.0 + shift * problem.simulation_error);
      const bool outside = hz < *begin || hz > *(end - 1);
      if (outside && shift != 0.0) continue;  // the band, and not the spectrum, would be wrong
      const double ratio = problem.damping_ratio(m);
      const double reach = kReach * ratio * hz;
      Scenario one{.mode = m, .first = 0, .count = 0, .weight = {}};
      one.first = std::lower_bound(begin, end, hz - reach) - begin;
      one.count = std::upper_bound(begin, end, hz + reach) - begin - one.first;
      for (Eigen::Index k = one.first; k < one.first + one.count; ++k) {
        one.weight.emplace_back(information(problem.line_hz(k), hz, ratio) * problem.sight(k, m));
      }
      scenarios.push_back(std::move(one));
    }
  }
  return scenarios;
}

// The wanted deviations of (ln ω, ln ζ), inverted and squared; 0: not asked for.
Eigen::Vector3d importance(const ShapeProblem& problem, Eigen::Index mode) {
  const double relative = problem.frequency_hz(mode) / problem.frequency_std_hz;
  return {std::isfinite(relative) ? relative * relative : 0.0,
          1.0 / (problem.damping_std * problem.damping_std), 0.0};
}

// Covariance of (ln ω, ln ζ, ln a) with the power of all inputs; huge where nothing tells of it.
Eigen::Matrix3d covariance(const ShapeProblem& problem, const Scenario& scenario,
                           const Eigen::MatrixXd& power) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (Eigen::Index k = 0; k < scenario.count; ++k) {
    const double drive = power.row(scenario.first + k).dot(problem.drive.row(scenario.mode));
    sum += drive * scenario.weight[static_cast<std::size_t>(k)];
  }
  const Eigen::Vector3d scale = sum.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d scaled =
      scale.asDiagonal() * sum * scale.asDiagonal() + 1e-12 * Eigen::Matrix3d::Identity();
  return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
}

// Neighbouring lines that have the same power: [first, end) of each bin.
std::vector<Eigen::Index> bins_of(const ShapeProblem& problem) {
  std::vector<Eigen::Index> starts{0};
  for (Eigen::Index k = 1; k < problem.line_hz.size(); ++k) {
    const double from = problem.line_hz(starts.back());
    if (problem.line_hz(k) > from * (1.0 + problem.simulation_error)) starts.push_back(k);
  }
  starts.push_back(problem.line_hz.size());
  return starts;
}

// Every input spends 1: Σ cost·power.
void spend_one(const Eigen::MatrixXd& cost, Eigen::MatrixXd& power) {
  for (Eigen::Index j = 0; j < power.cols(); ++j) power.col(j) /= cost.col(j).dot(power.col(j));
}

// Decrease of the norm of all variances by more power on each line: K×q.
Eigen::MatrixXd worth_of(const ShapeProblem& problem, const std::vector<Scenario>& scenarios,
                         const Eigen::MatrixXd& power) {
  std::vector<Eigen::Matrix3d> covariances;
  Eigen::VectorXd variance(static_cast<Eigen::Index>(scenarios.size()));
  for (std::size_t s = 0; s < scenarios.size(); ++s) {
    covariances.push_back(covariance(problem, scenarios[s], power));
    variance(static_cast<Eigen::Index>(s)) =
        covariances.back().diagonal().dot(importance(problem, scenarios[s].mode));
  }
  const double largest = variance.maxCoeff();
  Eigen::MatrixXd worth = Eigen::MatrixXd::Zero(power.rows(), power.cols());
  for (std::size_t s = 0; s < scenarios.size(); ++s) {
    const auto& one = scenarios[s];
    const double part = variance(static_cast<Eigen::Index>(s)) / largest;
    const Eigen::Matrix3d slope = covariances[s] * importance(problem, one.mode).asDiagonal() *
                                  covariances[s] * (part * part * part / largest);
    for (Eigen::Index k = 0; k < one.count; ++k) {
      const double gain = slope.cwiseProduct(one.weight[static_cast<std::size_t>(k)]).sum();
      worth.row(one.first + k) += gain * problem.drive.row(one.mode);
    }
  }
  return worth;
}

}  // namespace

Eigen::VectorXd expected_variance(const ShapeProblem& problem, const Eigen::MatrixXd& power) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(problem.frequency_hz.size());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(problem.frequency_hz.size());
  for (const auto& scenario : scenarios_of(problem)) {
    const Eigen::Vector3d variance = covariance(problem, scenario, power).diagonal();
    result(scenario.mode) += variance.cwiseProduct(importance(problem, scenario.mode)).maxCoeff();
    count(scenario.mode) += 1.0;
  }
  return result.cwiseQuotient(count);
}

Eigen::MatrixXd best_power(const ShapeProblem& problem, const Eigen::MatrixXd& cost) {
  const auto scenarios = scenarios_of(problem);
  const auto bins = bins_of(problem);
  Eigen::MatrixXd even = Eigen::MatrixXd::Ones(cost.rows(), cost.cols());
  spend_one(cost, even);
  Eigen::MatrixXd power = even;
  for (int step = 0; step < kSteps && !scenarios.empty(); ++step) {
    const Eigen::MatrixXd worth = worth_of(problem, scenarios, power);
    for (std::size_t b = 0; b + 1 < bins.size(); ++b) {
      const auto rows = Eigen::seqN(bins[b], bins[b + 1] - bins[b]);
      for (Eigen::Index j = 0; j < power.cols(); ++j) {
        power(rows, j) *= std::pow(worth(rows, j).sum() / cost(rows, j).sum(), kExponent);
      }
    }
    // An input that no mode needs keeps an even spectrum.
    for (Eigen::Index j = 0; j < power.cols(); ++j) {
      if (!(power.col(j).maxCoeff() > 0.0)) power.col(j) = even.col(j);
    }
    spend_one(cost, power);
  }
  return (1.0 - kEvenShare) * power + kEvenShare * even;
}

}  // namespace chladni::identification
