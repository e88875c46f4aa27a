// A plate with thirteen sensors whose modes are measured, and its study, which has fewer modes.
#pragma once

#include <string>

#include "simulators/plates/ritz_structure.h"

namespace chladni::diagnosis {

/// An aluminium plate of 600×470 mm with thirteen sensors in no order and one actuator.
[[nodiscard]] inline Structure wide_plate(Eigen::Index modes) {
  auto body = simulators::aluminium_table(8);
  body.width = 0.47;
  simulators::TableChannels channels;
  channels.outputs.resize(13, 2);
  channels.outputs << -0.27, -0.19, -0.06, -0.21, 0.13, -0.17, 0.28, -0.2, -0.22, -0.07, 0.02,
      -0.05, 0.2, -0.03, -0.29, 0.06, -0.1, 0.09, 0.09, 0.12, 0.26, 0.14, -0.19, 0.21, 0.11, 0.22;
  channels.inputs.resize(1, 2);
  channels.inputs << 0.25, -0.16;
  for (Eigen::Index i = 1; i <= 13; ++i) channels.output_names.push_back("s" + std::to_string(i));
  channels.input_names = {"a1"};
  simulators::RitzStructureOptions options;
  options.modes = modes;
  options.cells = 6;
  options.fine = 6;
  options.scan = 11;
  return simulators::ritz_structure(simulators::ritz_modes(body), channels, options);
}

/// What is diagnosed.
[[nodiscard]] inline const Structure& study() {
  static const Structure made = wide_plate(24);
  return made;
}

/// What is measured: it has 36 more modes.
[[nodiscard]] inline const Structure& truth() {
  static const Structure made = wide_plate(60);
  return made;
}

}  // namespace chladni::diagnosis
