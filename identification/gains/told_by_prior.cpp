#include "identification/gains/told_by_prior.h"

#include <cmath>

#include "base/error.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

// Deviations above 0, as the evidence needs them.
Eigen::VectorXd at_least_rounding(const Eigen::VectorXd& deviation, const Eigen::VectorXd& values) {
  const double rms = values.norm() / std::sqrt(static_cast<double>(values.size()));
  return deviation.cwiseMax(1e-6 * rms);
}

priors::TwoSidedShape shape_of(const TwoSides& sides, double frequency_hz, const GainPrior& prior) {
  const Eigen::VectorXd noise = sides.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {frequency_hz,
          prior.outputs,
          prior.inputs,
          sides.outputs,
          sides.inputs,
          at_least_rounding(noise.head(sides.outputs.size()), sides.outputs),
          at_least_rounding(noise.tail(sides.inputs.size()), sides.inputs)};
}

}  // namespace

priors::GainMatch told_by_prior(const TwoSides& sides, double frequency_hz,
                                const GainPrior& prior) {
  if (!(sides.outputs.norm() > 0.0 && sides.inputs.norm() > 0.0)) {
    throw NumericalFailure("all sensors or all actuators see nothing of it: not scaled");
  }
  const auto ln_beta = [&](const GainPrior& other, const priors::GainMatch& near) {
    return priors::log_gain_near(shape_of(sides, frequency_hz, other), other.basis, other.residual,
                                 near);
  };
  auto found =
      priors::gain_match(shape_of(sides, frequency_hz, prior), prior.basis, prior.residual);
  if (prior.aside.empty()) return found;
  const double middle = ln_beta(prior, found);
  double variance = found.deviation * found.deviation;
  for (const auto& other : prior.aside) variance += std::pow(ln_beta(other, found) - middle, 2);
  found.deviation = std::sqrt(variance);
  return found;
}

double deviation_of_sign(double certainty) {
  return certainty < Constants::sure_sign ? 2.0 * std::sqrt(1.0 - certainty) : 0.0;
}

}  // namespace chladni::identification
