// Levenberg's and Marquardt's descent to the likeliest block model.
#pragma once

#include "base/progress.h"
#include "identification/likelihood/normal_equations.h"

namespace chladni::identification {

struct Descent {
  BlockModel model;
  Misfit misfit;
  int iterations = 0;
  bool converged = false;
};

struct DescentOptions {
  int iterations = 60;
  double damping = 1e-4;   ///< of the normal equations scaled to a unit diagonal, at the start
  bool keep_best = false;  ///< an interrupt ends the descent instead of the program's work
  Progress progress = {};
};

/// Steps that lower the cost and keep every pole stable; each divides the damping by 10, a failure
/// multiplies it by 8. Converged: an undamped step, or two running, lower the cost by less than a
/// thousandth of what one number's noise adds to it, or nothing lowers it further.
[[nodiscard]] Descent descent(BlockModel start, const Target& target, const Fitted& fitted,
                              const DescentOptions& options);

}  // namespace chladni::identification
