#include "identification/control_model.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>

namespace chladni::identification {
namespace {

// States of complex modes: position and velocity of a rigid-body mode, then two without a name of
// their own.
std::vector<modal::Signal> complex_states(const modal::ReducedModel& model) {
  std::vector<modal::Signal> states;
  for (Eigen::Index m = 0; m < model.mode_count(); ++m) {
    const bool rigid = m < model.rigid_count;
    states.push_back({fmt::format("mode_{}_{}", m + 1, rigid ? "position" : "real"),
                      rigid ? "kg^1/2 m" : "kg^1/2 m / s^1/2"});
    states.push_back({fmt::format("mode_{}_{}", m + 1, rigid ? "velocity" : "imaginary"),
                      rigid ? "kg^1/2 m/s" : states.back().unit});
  }
  return states;
}

// L T and T⁻¹ R with the T that brings R next to the matched input shapes: a number for each mode,
// a matrix for all modes at 0 Hz together. The responses stay those of the fit.
modal::ReducedModel in_scale_of(const GainMatch& match, modal::ReducedModel model) {
  const auto change = [&](Eigen::Index first, Eigen::Index count) {
    if (count == 0) return;
    const Eigen::MatrixXd matched = match.input_shapes.middleRows(first, count);
    const Eigen::MatrixXd own = model.input_shapes.middleRows(first, count);
    const Eigen::MatrixXd turn =
        matched.transpose().colPivHouseholderQr().solve(own.transpose()).transpose();
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(turn);
    if (!turn.allFinite() || !lu.isInvertible()) return;
    model.output_shapes.middleCols(first, count) *= turn;
    model.input_shapes.middleRows(first, count) = lu.solve(own);
  };
  change(0, model.rigid_count);
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) change(m, 1);
  if (model.residual.size() == 0) {
    model.residual.setZero(model.output_count(), model.input_count());
  }
  return model;
}

// Delays of the channels of one side, as the fit has them.
Eigen::VectorXd delays(const ModalFit& fit, Eigen::Index count, bool own) {
  Eigen::VectorXd delay = Eigen::VectorXd::Zero(count);
  if (own) delay.setConstant(fit.delay_s);
  if (own && fit.channel_delay_s.size() == count) delay += fit.channel_delay_s;
  return delay;
}

Eigen::VectorXd channel_delays(const ModalFit& fit) {
  const bool outputs = fit.delay_of == DelayOf::outputs;
  return delays(fit, outputs ? fit.model.output_count() : fit.model.input_count(), true);
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
  const bool of_outputs = fit.delay_of == DelayOf::outputs;
  model.output_delay = delays(fit, fit.model.output_count(), of_outputs).cwiseMax(0.0);
  model.input_delay = delays(fit, fit.model.input_count(), !of_outputs).cwiseMax(0.0);
  return model;
}

std::vector<std::string> left_out_of_control_model(
    const ModalFit& fit, const std::vector<modal::MeasuredChannel>& outputs) {
  std::vector<std::string> notes;
  const double earliest = channel_delays(fit).minCoeff();
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
  return notes;
}

}  // namespace chladni::identification
