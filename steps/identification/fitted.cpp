#include "steps/fitted.h"

#include <complex>
#include <numbers>

#include "base/error.h"

namespace chladni::steps {

Eigen::VectorXcd poles(const IdentifiedModel& model) {
  const auto& modes = model.found.fit.model;
  Eigen::VectorXcd result(modes.mode_count());
  for (Eigen::Index m = 0; m < result.size(); ++m) {
    const double omega = 2.0 * std::numbers::pi * modes.frequency_hz(m);
    const std::complex<double> zeta = modes.damping_ratio(m);
    result(m) = omega * (-zeta + std::complex<double>(0.0, 1.0) * std::sqrt(1.0 - zeta * zeta));
  }
  return result;
}

modal::FrfSet fitted_responses(const IdentifiedModel& model, const Eigen::VectorXd& frequency_hz) {
  const auto& fit = model.found.fit;
  require(frequency_hz.allFinite() && (frequency_hz.array() >= 0.0).all(),
          "a frequency is negative or not finite; expected 0 or more");
  require(fit.model.rigid_count == 0 || (frequency_hz.array() > 0.0).all(),
          "a frequency is 0, where a model with modes at 0 Hz is infinite; expected more than 0");
  modal::FrfSet set;
  set.outputs = model.seen.outputs;
  set.inputs = model.seen.inputs;
  for (auto& output : set.outputs) {
    output.kind = modal::FrfKind::receptance;
    if (!output.unit.empty()) output.unit = "m";
  }
  set.frequency_hz = frequency_hz;
  const auto p = set.output_count();
  const auto q = set.input_count();
  const Eigen::MatrixXcd all = identification::responses(fit, frequency_hz);  // K×pq
  for (Eigen::Index k = 0; k < frequency_hz.size(); ++k) {
    const Eigen::VectorXcd line = all.row(k).transpose();
    set.value.emplace_back(line.reshaped(p, q));
  }
  return set;
}

}  // namespace chladni::steps
