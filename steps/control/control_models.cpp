#include "steps/control_models.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "identification/control_model.h"
#include "stage/at_channels.h"

namespace chladni::steps {
namespace {

// Hankel singular values cost n³: with more states they are computed for a reduction alone.
constexpr Eigen::Index kManyStates = 200;

double sample_rate(const study::Study& study, const study::StateSpacePlan& plan) {
  if (plan.sample_rate_hz > 0.0) return plan.sample_rate_hz;
  return study.experiment ? study.experiment->sample_rate_hz : 0.0;
}

// False where a mode above 0 Hz has no damping: it has no Hankel singular values.
bool is_damped(const modal::ControlModel& model) {
  const Eigen::VectorXcd poles = model.space.a.eigenvalues();
  const double largest = poles.size() > 0 ? poles.cwiseAbs().maxCoeff() : 0.0;
  return std::all_of(poles.begin(), poles.end(), [&](const auto& pole) {
    return pole.real() < 0.0 || std::abs(pole) <= 1e-7 * largest;
  });
}

// Factors from the position states of the modes to their coordinates.
std::vector<double> positions(const Eigen::VectorXd& frequency_hz, Eigen::Index rigid_count) {
  std::vector<double> factors;
  for (Eigen::Index m = 0; m < frequency_hz.size(); ++m) {
    factors.push_back(m < rigid_count ? 1.0 : 0.5 / (std::numbers::pi * frequency_hz(m)));
  }
  return factors;
}

void reduce(const study::StateSpacePlan& plan, ControlModels& models) {
  auto& model = models.continuous;
  const bool asked = plan.states > 0 && plan.states != models.all_states;
  if (!asked && models.all_states > kManyStates) return;
  if (!asked && !is_damped(model)) return;
  const auto small = modal::reduced(model, asked ? plan.states : models.all_states);
  models.hankel = small.hankel;
  if (!asked) return;
  models.error_bound = small.error_bound;
  model = small.model;
}

void sample(double rate_hz, ControlModels& models) {
  models.discrete = modal::discretised(models.continuous, 1.0 / rate_hz);
  const double highest = modal::poles(models.continuous).highest_hz();
  if (highest < 0.5 * rate_hz) return;
  models.notes.push_back(
      fmt::format("a mode at {:.6g} Hz lies above half of the sample rate: what the discrete model "
                  "shows of it is an alias",
                  highest));
}

void approximate_delays(int order, ControlModels& models) {
  const double limit = modal::pade_limit_hz(models.continuous, order, std::numbers::pi / 180.0);
  if (std::isinf(limit)) return;
  models.notes.push_back(fmt::format(
      "the Pade delays of the continuous model are right within 1 degree below {:.4g} Hz", limit));
  models.continuous = modal::with_pade_delays(models.continuous, order);
}

}  // namespace

ControlModels control_models(const study::Study& study, const modal::ControlModel& whole) {
  const auto plan = study.state_space.value_or(study::StateSpacePlan{});
  ControlModels models;
  models.continuous = whole;
  models.all_states = whole.space.a.rows();
  try {
    reduce(plan, models);
    models.kept_states = models.continuous.space.a.rows();
    if (const double rate = sample_rate(study, plan); rate > 0.0) sample(rate, models);
    if (plan.pade_order > 0) approximate_delays(plan.pade_order, models);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(study.file.string() + ": [state_space]: " + fault.what());
  }
  return models;
}

ControlModels control_models(const study::Study& study, const stage::Solution& solution) {
  require(!study.sensors.empty() && !study.actuators.empty(),
          study.file.string() + ": [state_space] needs a sensor and an actuator");
  std::vector<modal::OutputChannel> outputs;
  for (const auto& sensor : study.sensors) {
    outputs.push_back({sensor.name, kind_of(sensor.quantity)});
  }
  const auto modes = stage::at_channels(study, solution);
  auto models =
      control_models(study, modal::control_model(modes, outputs, study::names_of(study.actuators)));
  const bool moving = std::any_of(outputs.begin(), outputs.end(), [](const auto& output) {
    return output.kind != modal::FrfKind::receptance;
  });
  if (moving) {
    models.notes.emplace_back(
        "sensors of velocity or acceleration are without the flexibility of the omitted modes: its "
        "derivative is in no state space");
  }
  if (models.kept_states == models.all_states) {
    models.position = positions(modes.frequency_hz, modes.rigid_count);
  }
  return models;
}

ControlModels control_models(const study::Study& study, const IdentifiedModel& model) {
  const auto& fit = model.found.fit;
  auto models = control_models(study, identification::control_model(
                                          fit, model.match, model.seen.outputs, model.seen.inputs));
  const auto left_out = identification::left_out_of_control_model(fit, model.seen.outputs);
  models.notes.insert(models.notes.begin(), left_out.begin(), left_out.end());
  if (fit.complex || models.kept_states < models.all_states) return models;
  models.position = positions(fit.model.frequency_hz, fit.model.rigid_count);
  return models;
}

}  // namespace chladni::steps
