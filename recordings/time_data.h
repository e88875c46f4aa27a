// The recorded samples of an experiment.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::recordings {

/// One uninterrupted recording of N samples.
struct Record {
  Eigen::MatrixXd outputs;     ///< N×p
  Eigen::MatrixXd inputs;      ///< N×q: forces on the structure
  Eigen::MatrixXd references;  ///< N×r: signals added in a loop; N×0 in open loop
  int experiment = 0;          ///< records of one realisation of a MIMO excitation count from 0
  int realisation = 0;         ///< index of the random phases, from 0
};

/// All recordings of one structure. Values are in SI where the channels' units are stated.
struct TimeData {
  std::vector<modal::MeasuredChannel> outputs, inputs, references;
  double sample_time_s = 0.0;
  Eigen::Index period = 0;  ///< samples of the periodic excitation; 0: not periodic
  std::vector<Record> records;
};

/// The sides of a recording.
enum class Side { outputs, inputs, references };

/// @throws InvalidInput  sizes differ, a sample is not finite, a name is empty or occurs twice
void check(const TimeData& data);

/// What keeps responses from being estimated at all: there is no output, or no input. Empty:
/// nothing.
[[nodiscard]] std::string missing_side(const TimeData& head);

}  // namespace chladni::recordings
