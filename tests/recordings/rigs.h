// Small structures that the tests of experiments shake.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modal/reduced_model.h"
#include "recordings/virtual_experiment.h"

namespace chladni::recordings {

inline std::vector<modal::MeasuredChannel> channels(const std::string& letter, Eigen::Index count) {
  std::vector<modal::MeasuredChannel> result;
  for (Eigen::Index i = 0; i < count; ++i) {
    modal::MeasuredChannel channel;
    channel.name = letter + std::to_string(i + 1);
    channel.unit.assign(1, letter == "y" ? 'm' : 'N');  // of "m" GCC 12 thinks overflow
    result.push_back(channel);
  }
  return result;
}

/// p outputs and q inputs; frequencies of 0 first.
inline modal::ReducedModel model_of(const Eigen::VectorXd& frequency_hz, double damping_ratio,
                                    const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs) {
  modal::ReducedModel model;
  model.frequency_hz = frequency_hz;
  model.damping_ratio = Eigen::VectorXd::Constant(frequency_hz.size(), damping_ratio);
  model.rigid_count = (frequency_hz.array() == 0.0).count();
  model.damping_ratio.head(model.rigid_count).setZero();
  model.output_shapes = outputs;
  model.input_shapes = inputs;
  model.residual.setZero(outputs.rows(), inputs.cols());
  const auto m = frequency_hz.size();
  model.dampers = {Eigen::MatrixXd(0, m), Eigen::MatrixXd(outputs.rows(), 0),
                   Eigen::MatrixXd(0, inputs.cols()), Eigen::MatrixXd(0, 0)};
  return model;
}

/// Two sensors, two actuators, modes at 20 and 47 Hz.
inline modal::ReducedModel two_modes(double damping_ratio = 0.02) {
  Eigen::Matrix2d shapes;
  shapes << 1.0, 0.6, -0.5, 1.1;
  return model_of(Eigen::Vector2d(20.0, 47.0), damping_ratio, shapes, shapes.transpose());
}

inline VirtualRig rig_of(const modal::ReducedModel& model, double sampling_hz) {
  VirtualRig rig;
  rig.plant = plant(model);
  rig.outputs = channels("y", model.output_count());
  rig.inputs = channels("u", model.input_count());
  rig.sample_time_s = 1.0 / sampling_hz;
  return rig;
}

/// Lines of 1 Hz at 512 Hz, 5 to 80 Hz.
inline VirtualExperimentPlan plan_of_seconds(Eigen::Index periods = 6) {
  VirtualExperimentPlan plan;
  plan.multisine.period = 512;
  plan.multisine.sample_time_s = 1.0 / 512.0;
  plan.multisine.low_hz = 5.0;
  plan.multisine.high_hz = 80.0;
  plan.periods = periods;
  return plan;
}

}  // namespace chladni::recordings
