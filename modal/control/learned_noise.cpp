#include "modal/learned_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/search.h"
#include "modal/kalman_filter.h"

namespace chladni::modal {
namespace {

constexpr double kFarthest = 9.210340371976184;  // ln 1e4
constexpr int kScanned = 12;                     // intervals of the ratio

// Innovations of all settled samples under one ratio of the factors, sensors over disturbances.
struct Innovations {
  double samples = 0.0;
  double log_determinant = 0.0;  // of the covariance that the filter states
  double mean_square = 0.0;      // of the whitened innovations, per number

  // −2/N ln likelihood at the size of the noise that suits it best, without its constant part.
  [[nodiscard]] double misfit(double sensors) const {
    return log_determinant + sensors * std::log(mean_square);
  }
  // The same at the stated size.
  [[nodiscard]] double misfit_as_stated(double sensors) const {
    return log_determinant + sensors * (mean_square - 1.0);
  }
};

Innovations innovations(const DisturbedModel& system, std::span<const RecordedSamples> records,
                        Eigen::Index from) {
  const auto filter = kalman_filter(system);
  const Eigen::LLT<Eigen::MatrixXd> stated(filter.innovation);
  Innovations result;
  double sum = 0.0;
  for (const auto& record : records) {
    const auto settled = record.outputs.rows() - from;
    if (settled <= 0) continue;
    const auto found = estimate(filter, record.inputs, record.outputs).innovation;
    sum += stated.matrixL().solve(found.bottomRows(settled).transpose()).squaredNorm();
    result.samples += static_cast<double>(settled);
  }
  result.log_determinant = 2.0 * stated.matrixLLT().diagonal().array().log().sum();
  result.mean_square = sum / (result.samples * static_cast<double>(system.sensors));
  return result;
}

void require_settled(std::span<const RecordedSamples> records, Eigen::Index from) {
  const auto is_long = [&](const RecordedSamples& record) { return record.outputs.rows() > from; };
  require(std::ranges::any_of(records, is_long),
          "learned_noise: no record is longer than the samples in which the filter settles");
}

// The model whose only wanted output is sensor i, which is no sensor any more.
DisturbedModel with_sensor_wanted(DisturbedModel system, const std::vector<Eigen::Index>& others,
                                  Eigen::Index i) {
  auto rows = others;
  rows.push_back(i);
  auto& model = system.model;
  model.space.c = model.space.c(rows, Eigen::all).eval();
  model.space.d = model.space.d(rows, Eigen::all).eval();
  std::vector<Signal> outputs;
  for (const auto row : rows) outputs.push_back(model.outputs[static_cast<std::size_t>(row)]);
  model.outputs = std::move(outputs);
  model.output_delay = model.output_delay(rows).eval();
  system.sensor_rms = system.sensor_rms(others).eval();
  system.sensors = std::ssize(others);
  return system;
}

double left_out_error(const DisturbedModel& system, Eigen::Index i,
                      std::span<const RecordedSamples> records, Eigen::Index from) {
  std::vector<Eigen::Index> others;
  for (Eigen::Index k = 0; k < system.sensors; ++k) {
    if (k != i) others.push_back(k);
  }
  const auto without = with_sensor_wanted(system, others, i);
  if (others.empty() || !unseen_states(without).empty()) return std::nan("");
  const auto filter = kalman_filter(without);
  const double variance = filter.point_covariance(0, 0) + std::pow(system.sensor_rms(i), 2);
  double sum = 0.0;
  double samples = 0.0;
  for (const auto& record : records) {
    const auto settled = record.outputs.rows() - from;
    if (settled <= 0) continue;
    const Eigen::MatrixXd seen = record.outputs(Eigen::all, others);
    const auto found = estimate(filter, record.inputs, seen);
    sum += (found.points.col(0) - record.outputs.col(i)).tail(settled).squaredNorm();
    samples += static_cast<double>(settled);
  }
  return std::sqrt(sum / samples / variance);
}

}  // namespace

DisturbedModel with_noise(DisturbedModel system, const NoiseFactors& factors) {
  system.noise_rms *= factors.disturbances;
  system.sensor_rms *= factors.sensors;
  return system;
}

Eigen::VectorXd left_out_errors(const DisturbedModel& system,
                                std::span<const RecordedSamples> records, Eigen::Index from) {
  require_settled(records, from);
  Eigen::VectorXd errors(system.sensors);
  for (Eigen::Index i = 0; i < system.sensors; ++i) {
    errors(i) = left_out_error(system, i, records, from);
  }
  return errors;
}

NoiseFactors learned_noise(const DisturbedModel& system, std::span<const RecordedSamples> records,
                           Eigen::Index from) {
  require_settled(records, from);
  const auto p = static_cast<double>(system.sensors);
  // The geometric mean of the factors stays 1.
  const auto at_ratio = [&](double log_ratio) {
    const double root = std::exp(0.5 * log_ratio);
    return innovations(with_noise(system, {1.0 / root, root}), records, from);
  };
  const auto misfit = [&](double log_ratio) {
    try {
      return at_ratio(log_ratio).misfit(p);
    } catch (const NumericalFailure&) {
      return HUGE_VAL;
    }
  };
  const auto best = minimum_in(misfit, -kFarthest, kFarthest, kScanned);
  const auto found = at_ratio(best.at);
  const auto stated = at_ratio(0.0);
  const double size = std::sqrt(found.mean_square);
  const double root = std::exp(0.5 * best.at);
  return {size / root, size * root,
          0.5 * found.samples * (stated.misfit_as_stated(p) - found.misfit(p)),
          best.at_low || best.at_high};
}

}  // namespace chladni::modal
