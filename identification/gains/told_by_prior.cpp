#include "identification/gains/told_by_prior.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

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

// ln β of another simulation near that of one, if it tells any.
std::optional<double> ln_beta_near(const priors::GainMatch& near, const TwoSides& sides,
                                   double frequency_hz, const GainPrior& other) {
  try {
    return priors::log_gain_near(shape_of(sides, frequency_hz, other), other.basis, other.residual,
                                 near);
  } catch (const NumericalFailure&) {
    return std::nullopt;  // doubts_of_told says so
  }
}

}  // namespace

ToldByPrior told_by_prior(const TwoSides& sides, double frequency_hz, const GainPrior& prior) {
  if (!(sides.outputs.norm() > 0.0 && sides.inputs.norm() > 0.0)) {
    throw NumericalFailure("all sensors or all actuators see nothing of it: not scaled");
  }
  ToldByPrior told;
  auto& found = told.gain;
  found = priors::gain_match(shape_of(sides, frequency_hz, prior), prior.basis, prior.residual);
  if (prior.aside.empty()) return told;
  const double middle = ln_beta_near(found, sides, frequency_hz, prior).value_or(found.log_gain);
  double variance = found.deviation * found.deviation;
  for (const auto& other : prior.aside) {
    const auto moved = ln_beta_near(found, sides, frequency_hz, other);
    variance += moved ? std::pow(*moved - middle, 2) : 0.0;
    told.left_out += moved ? 0 : 1;
  }
  found.deviation = std::sqrt(variance);
  return told;
}

std::vector<std::string> doubts_of_told(const ToldByPrior& told, std::size_t aside) {
  std::vector<std::string> doubts;
  if (told.gain.certainty < Constants::sure_sign) {
    const double percent = 0.1 * std::floor(1e3 * told.gain.certainty);  // not up to the limit
    doubts.push_back(fmt::format(
        "the simulation tells the sign of its actuators with a certainty of {:.3g} % only",
        percent));
  }
  if (told.left_out > 0) {
    doubts.push_back(
        fmt::format("{} of {} other plausible simulations tell no scale of it; "
                    "its deviation leaves them out",
                    told.left_out, aside));
  }
  return doubts;
}

double deviation_of_sign(double certainty) {
  return certainty < Constants::sure_sign ? 2.0 * std::sqrt(1.0 - certainty) : 0.0;
}

}  // namespace chladni::identification
