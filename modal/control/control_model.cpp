#include "modal/control_model.h"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.h"

namespace chladni::modal {
namespace {

const char* unit_of(FrfKind kind) {
  if (kind == FrfKind::mobility) return "m/s";
  return kind == FrfKind::accelerance ? "m/s^2" : "m";
}

// The output `row` differentiated once: ẏ = C A x + C B u, without D u̇.
void differentiate(const StateSpace& space, Eigen::Index row, StateSpace& into) {
  into.d.row(row) = into.c.row(row) * space.b;
  into.c.row(row) = (into.c.row(row) * space.a).eval();
}

// States of a mode beside each other: from (all positions, all velocities, dashpots).
std::vector<Eigen::Index> by_modes(Eigen::Index modes, Eigen::Index states) {
  std::vector<Eigen::Index> order;
  for (Eigen::Index m = 0; m < modes; ++m) {
    order.push_back(m);
    order.push_back(modes + m);
  }
  for (auto s = 2 * modes; s < states; ++s) order.push_back(s);
  return order;
}

std::vector<Signal> states_of(const ReducedModel& model, Eigen::Index count) {
  std::vector<Signal> states;
  for (Eigen::Index m = 0; m < model.mode_count(); ++m) {
    const bool rigid = m < model.rigid_count;
    states.push_back({fmt::format("mode_{}_{}", m + 1, rigid ? "position" : "omega_position"),
                      rigid ? "kg^1/2 m" : "kg^1/2 m/s"});
    states.push_back({fmt::format("mode_{}_velocity", m + 1), "kg^1/2 m/s"});
  }
  for (auto s = 2 * model.mode_count(); s < count; ++s) {
    states.push_back({fmt::format("dashpot_{}", s - 2 * model.mode_count() + 1), "W^1/2"});
  }
  return states;
}

void check_delays(const ControlModel& model, const Eigen::VectorXd& delay,
                  const std::vector<Signal>& channels, const char* side) {
  const bool discrete = model.space.sample_time_s > 0.0;
  for (Eigen::Index i = 0; i < delay.size(); ++i) {
    const double value = delay(i);
    const bool sound =
        !discrete || (value == std::round(value) && value <= kMostDelaySamples + 1.0);
    require(
        std::isfinite(value) && value >= 0.0 && sound,
        fmt::format(
            "control model: the delay of {} \"{}\" is {} {}; expected 0 {}", side,
            channels[static_cast<std::size_t>(i)].name, value, discrete ? "samples" : "s",
            discrete ? fmt::format("to {} samples, whole", kMostDelaySamples + 1.0) : "or more"));
  }
}

void require_names(const StateSpace& space, const std::vector<OutputChannel>& outputs,
                   const std::vector<std::string>& inputs) {
  require(outputs.size() == static_cast<std::size_t>(space.c.rows()) &&
              inputs.size() == static_cast<std::size_t>(space.b.cols()),
          fmt::format(
              "control model: found names of {} outputs and {} inputs, expected {} and {} names",
              outputs.size(), inputs.size(), space.c.rows(), space.b.cols()));
}

ControlModel named(const StateSpace& space, const std::vector<Signal>& states,
                   const std::vector<OutputChannel>& outputs,
                   const std::vector<std::string>& inputs) {
  ControlModel model{space, states, {}, {}, {}, {}};
  for (const auto& output : outputs) model.outputs.push_back({output.name, unit_of(output.kind)});
  for (const auto& input : inputs) model.inputs.push_back({input, "N"});
  model.input_delay.setZero(space.b.cols());
  model.output_delay.setZero(space.c.rows());
  check(model);
  return model;
}

}  // namespace

ControlModel control_model(const StateSpace& displacements, const std::vector<Signal>& states,
                           const std::vector<OutputChannel>& outputs,
                           const std::vector<std::string>& inputs) {
  require_names(displacements, outputs, inputs);
  auto space = displacements;
  for (Eigen::Index i = 0; i < displacements.c.rows(); ++i) {
    const auto kind = outputs[static_cast<std::size_t>(i)].kind;
    if (kind != FrfKind::receptance) differentiate(displacements, i, space);
    if (kind == FrfKind::accelerance) differentiate(displacements, i, space);
  }
  return named(space, states, outputs, inputs);
}

ControlModel control_model(const ReducedModel& model, const std::vector<OutputChannel>& outputs,
                           const std::vector<std::string>& inputs) {
  auto space = state_space(model);
  require_names(space, outputs, inputs);
  for (const auto kind : {FrfKind::mobility, FrfKind::accelerance}) {
    const auto moving = state_space(model, kind);  // A and B are the same
    for (Eigen::Index i = 0; i < space.c.rows(); ++i) {
      if (outputs[static_cast<std::size_t>(i)].kind != kind) continue;
      space.c.row(i) = moving.c.row(i);
      space.d.row(i) = moving.d.row(i);
    }
  }
  const auto order = by_modes(model.mode_count(), space.a.rows());
  space.a = space.a(order, order).eval();
  space.b = space.b(order, Eigen::all).eval();
  space.c = space.c(Eigen::all, order).eval();
  return named(space, states_of(model, space.a.rows()), outputs, inputs);
}

void check(const ControlModel& model) {
  const auto& space = model.space;
  const auto n = space.a.rows();
  const auto count = [](const auto& names) { return static_cast<Eigen::Index>(names.size()); };
  require(space.a.cols() == n && space.b.rows() == n && space.c.cols() == n &&
              space.d.rows() == space.c.rows() && space.d.cols() == space.b.cols(),
          "control model: the sizes of A, B, C and D do not fit together");
  require(count(model.states) == n && count(model.inputs) == space.b.cols() &&
              count(model.outputs) == space.c.rows() &&
              model.input_delay.size() == space.b.cols() &&
              model.output_delay.size() == space.c.rows(),
          "control model: names or delays do not fit the sizes of A, B and C");
  require(space.a.allFinite() && space.b.allFinite() && space.c.allFinite() && space.d.allFinite(),
          "control model: an entry of A, B, C or D is not finite");
  check_delays(model, model.input_delay, model.inputs, "input");
  check_delays(model, model.output_delay, model.outputs, "output");
}

Eigen::MatrixXcd response(const ControlModel& model, double frequency_hz) {
  check(model);
  Eigen::MatrixXcd value = response(model.space, frequency_hz);
  const double unit = model.space.sample_time_s > 0.0 ? model.space.sample_time_s : 1.0;
  const std::complex<double> lag(0.0, -2.0 * std::numbers::pi * frequency_hz * unit);
  const Eigen::VectorXcd after =
      (model.output_delay.cast<std::complex<double>>() * lag).array().exp();
  const Eigen::VectorXcd before =
      (model.input_delay.cast<std::complex<double>>() * lag).array().exp();
  return after.asDiagonal() * value * before.asDiagonal();
}

}  // namespace chladni::modal
