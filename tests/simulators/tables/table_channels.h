// The actuators and sensors of the wafer table: the channels of models/oat/minimal.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::simulators {

/// Channels along z.
struct TableChannels {
  std::vector<std::string> output_names, input_names;
  Eigen::MatrixX2d outputs, inputs;  ///< [m]
};

/// s1 to s4 at (±250, ±250) mm, a1 to a13.
[[nodiscard]] TableChannels table_channels();

/// Channels along z as a test sheet states them.
/// @param places  n×2 [m], one for each name
[[nodiscard]] std::vector<modal::MeasuredChannel> measured_channels(
    const std::vector<std::string>& names, const Eigen::MatrixX2d& places, const std::string& unit);

}  // namespace chladni::simulators
