// A measured mode beside the simulated ones.
#pragma once

#include <limits>

namespace chladni::diagnosis {

/// A measured mode beside the modes before and after the causes. NaN: none.
struct ModeTold {
  double measured_hz = 0.0, before_hz = 0.0, after_hz = 0.0;
  double mac_before = 0.0, mac_after = 0.0;  ///< at sensors times at actuators
  /// In the reference; NaN: it has no such mode, or there is no reference.
  double reference_hz = std::numeric_limits<double>::quiet_NaN();
  /// Deviation of the measured frequency; NaN: not known.
  double measured_std_hz = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace chladni::diagnosis
