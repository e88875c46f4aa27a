// The actuators and sensors of the wafer table: the channels of models/oat/minimal.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace chladni::simulators {

/// Channels along z.
struct TableChannels {
  std::vector<std::string> output_names, input_names;
  Eigen::MatrixX2d outputs, inputs;  ///< [m]
};

/// s1 to s4 at (±250, ±250) mm, a1 to a13.
[[nodiscard]] TableChannels table_channels();

}  // namespace chladni::simulators
