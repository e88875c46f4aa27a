// A small plate that a diagnosis starts from, quick to make.
#pragma once

#include "simulators/hidden_effect.h"
#include "simulators/ritz_structure.h"

namespace chladni::diagnosis {

/// Degree 8, 24 modes, 6×6 cells.
[[nodiscard]] inline const Structure& small_plate() {
  static const Structure made = [] {
    simulators::RitzStructureOptions options;
    options.modes = 24;
    options.cells = 6;
    options.scan = 11;
    return simulators::ritz_structure(simulators::believed_table(8), simulators::table_channels(),
                                      options);
  }();
  return made;
}

[[nodiscard]] inline Eigen::VectorXd some_lines() {
  return 2.0 * 3.14159265358979 * Eigen::VectorXd::LinSpaced(23, 31.0, 893.0);
}

}  // namespace chladni::diagnosis
