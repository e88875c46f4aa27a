// A model for control under random disturbances that nobody measures, sampled.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modal/control_model.h"

namespace chladni::modal {

/// Course of a random disturbance in time.
enum class DisturbanceCourse {
  white,  ///< a new value at each sample, held until the next
  band,   ///< first-order slopes below `low_hz` (0: none) and above `high_hz`
  drift,  ///< a sum of random steps: any level, which changes slowly
};

/// A random signal of mean 0 at one input of a model.
struct Disturbance {
  std::string name;
  Eigen::Index input = 0;  ///< of the model; several disturbances may share one
  DisturbanceCourse course = DisturbanceCourse::white;
  double rms = 0.0;      ///< of the signal, in the unit of the input; of a drift that of its change
                         ///< within `drift_time_s`
  double density = 0.0;  ///< instead of rms: one-sided power spectral density [unit²/Hz]; of a band
                         ///< between its slopes
  double low_hz = 0.0, high_hz = 0.0;  ///< of a band
  double drift_time_s = 1.0;
};

/// Course of a known input from sample to sample.
enum class InputCourse {
  held,    ///< a command: it keeps its value
  linear,  ///< a measured force: a straight line to its next value
};

/// x⁺ = A x + B [u; w], [y; z] = C x + D [u; w] at the samples. u: the known inputs, with delays of
/// whole samples; w: independent white noise, held between samples. y: the sensors; z: what is
/// wanted. Delays of sensors are states.
struct DisturbedModel {
  ControlModel model;          ///< inputs u, then w; outputs y, then z
  Eigen::Index known = 0;      ///< of u
  Eigen::Index sensors = 0;    ///< of y
  Eigen::VectorXd noise_rms;   ///< of w
  Eigen::VectorXd sensor_rms;  ///< of the noise of y, independent at each sample
  /// n×u of linear inputs: the states of `model` are x − `ahead` u of the same sample; empty: x.
  Eigen::MatrixXd ahead;

  [[nodiscard]] Eigen::Index state_count() const { return model.space.a.rows(); }
  [[nodiscard]] Eigen::Index wanted_count() const { return model.space.c.rows() - sensors; }
  // The parts of B, C and D.
  [[nodiscard]] Eigen::MatrixXd known_inputs() const { return model.space.b.leftCols(known); }
  /// n×w: what a deviation of the noise does to the states.
  [[nodiscard]] Eigen::MatrixXd noise_inputs() const;
  /// (p+z)×w: likewise to the outputs at once.
  [[nodiscard]] Eigen::MatrixXd noise_through() const;
};

/// @param continuous    its inputs: `known` ones, then those at which only disturbances act; its
///                      outputs: the sensors, then what is wanted
/// @param sensor_rms    of the noise of each sensor, above 0; their number is that of the sensors
/// @param course        of all known inputs
/// @throws InvalidInput  as discretised and with_delay_states; a disturbance at no input, without
///                       rms and density or with both, with a band that is not ascending or above
///                       half of the sample rate; noise of a sensor that is not positive
[[nodiscard]] DisturbedModel disturbed_model(const ControlModel& continuous, Eigen::Index known,
                                             const std::vector<Disturbance>& disturbances,
                                             const Eigen::VectorXd& sensor_rms,
                                             double sample_time_s,
                                             InputCourse course = InputCourse::held);

}  // namespace chladni::modal
