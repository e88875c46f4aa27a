// What an experiment records, sample by sample.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::identification {

/// One uninterrupted recording of N samples.
struct Record {
  Eigen::MatrixXd outputs;     ///< N×p
  Eigen::MatrixXd inputs;      ///< N×q: what acted on the structure
  Eigen::MatrixXd references;  ///< N×r: what was injected into a loop; N×0 in open loop
  int experiment = 0;          ///< records of one realisation of a MIMO excitation count from 0
  int realisation = 0;         ///< of the random phases, from 0
};

/// All recordings of one structure. In SI where the channels' units are stated.
struct TimeData {
  std::vector<modal::MeasuredChannel> outputs, inputs, references;
  double sample_time_s = 0.0;
  Eigen::Index period = 0;  ///< samples of the periodic excitation; 0: not periodic
  std::vector<Record> records;
};

/// @throws InvalidInput  sizes differ, a sample is not finite, names are empty or twice
void check(const TimeData& data);

}  // namespace chladni::identification
