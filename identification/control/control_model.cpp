#include "identification/control_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identification/constants.h"
#include "identification/control/scaled_model.h"

namespace chladni::identification {
namespace {

// A deviation of 0 is none: it was not computed.
bool is_below_zero(double delay, double deviation) {
  return delay < (deviation > 0.0 ? -Constants::no_delay * deviation : 0.0);
}

// The earliest delay of those that are below 0 [s]; 0 without such. A channel that was not measured
// has an infinite deviation, and thus none.
double earliest_delay(const ModalFit& fit) {
  const auto& own = fit.channel_delay_s;
  if (own.size() == 0) return is_below_zero(fit.delay_s, fit.delay_std_s) ? fit.delay_s : 0.0;
  const bool is_known = fit.channel_delay_std_s.size() == own.size();
  double earliest = 0.0;
  for (Eigen::Index i = 0; i < own.size(); ++i) {
    const double delay = fit.delay_s + own(i);
    if (is_below_zero(delay, is_known ? fit.channel_delay_std_s(i) : 0.0)) {
      earliest = std::min(earliest, delay);
    }
  }
  return earliest;
}

// The velocity that a force gives accelerometers at once, C B, relative to what single states add
// to it. It is 0 of real shapes, and of complex ones if all modes of a structure are there.
double step_of_velocity(const ModalFit& fit, const std::vector<modal::MeasuredChannel>& outputs) {
  if (!fit.complex) return 0.0;
  const auto space = state_space(fit.model, *fit.complex);
  double step = 0.0;
  double parts = 0.0;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].kind != modal::FrfKind::accelerance) continue;
    const auto row = space.c.row(static_cast<Eigen::Index>(i));
    step += (row * space.b).squaredNorm();
    parts += (row.cwiseAbs2() * space.b.cwiseAbs2()).sum();
  }
  return parts > 0.0 ? std::sqrt(step / parts) : 0.0;
}

}  // namespace

modal::ControlModel control_model(const ModalFit& fit, const GainMatch& match,
                                  const std::vector<modal::MeasuredChannel>& outputs,
                                  const std::vector<modal::MeasuredChannel>& inputs) {
  std::vector<modal::OutputChannel> rows;
  std::vector<std::string> columns;
  for (const auto& output : outputs) rows.push_back({output.name, output.kind});
  for (const auto& input : inputs) columns.push_back(input.name);
  modal::ControlModel model;
  if (fit.complex) {
    model = modal::control_model(state_space(fit.model, *fit.complex), complex_states(fit.model),
                                 rows, columns);
  } else {
    model = modal::control_model(in_scale_of(match, fit.model), rows, columns);
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {  // as they stand in the file
    const bool is_stated =
        !outputs[i].unit.empty() || outputs[i].kind != modal::FrfKind::receptance;
    if (!is_stated) model.outputs[i].unit.clear();
  }
  set_delays(fit, model);
  return model;
}

std::vector<std::string> left_out_of_control_model(
    const ModalFit& fit, const std::vector<modal::MeasuredChannel>& outputs) {
  std::vector<std::string> notes;
  const double earliest = earliest_delay(fit);
  if (earliest < 0.0) {
    notes.push_back(
        fmt::format("the fit has a delay of {:.3g} us; a state space cannot look ahead, so that it "
                    "has 0 there",
                    1e6 * earliest));
  }
  const auto moving = std::any_of(outputs.begin(), outputs.end(), [](const auto& output) {
    return output.kind != modal::FrfKind::receptance;
  });
  if (moving && fit.model.residual.size() > 0 && fit.model.residual.cwiseAbs().maxCoeff() > 0.0) {
    notes.emplace_back(
        "sensors of velocity or acceleration are without the flexibility of the modes above the "
        "band: its derivative is in no state space");
  }
  constexpr double kRounding = 1e-9;
  if (step_of_velocity(fit, outputs) > kRounding) {
    notes.emplace_back(
        "sensors of acceleration are without the part in which the complex shapes let a force "
        "change a velocity at once: its derivative is in no state space");
  }
  return notes;
}

}  // namespace chladni::identification
