#include "priors/dynamic_residual.h"

#include <fmt/format.h>

#include <string>

#include "base/error.h"

namespace chladni::priors {

Eigen::VectorXd coefficient_variances(const Eigen::VectorXd& frequency_hz, double real_hz,
                                      const DynamicResidual& prior) {
  const auto positive = [](double value, const char* name) {
    require(value > 0.0, std::string("dynamic residual: ") + name + " is " +
                             fmt::format("{:.6g}", value) + ", expected more than 0");
  };
  positive(real_hz, "real_hz");
  positive(prior.eta, "eta");
  positive(prior.kappa, "kappa");
  positive(prior.gamma, "gamma");
  const Eigen::ArrayXd r = prior.gamma * (frequency_hz / real_hz).array().square();
  return (r + prior.kappa) / ((r - 1.0).square() + prior.eta * prior.eta);
}

}  // namespace chladni::priors
