// Descent by Levenberg and Marquardt to the most likely block model.
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
  double damping = 1e-4;   ///< start value, for normal equations scaled to a unit diagonal
  bool keep_best = false;  ///< an interrupt ends only the descent, not the program's work
  Progress progress = {};
};

/// Takes steps that lower the cost and keep every pole stable. Each success divides the
/// damping by 10, each failure multiplies it by 8. It has converged if an undamped step, or
/// two steps in sequence, lower the cost by less than a thousandth of the noise level, or if
/// nothing lowers the cost.
[[nodiscard]] Descent descent(BlockModel start, const Target& target, const Fitted& fitted,
                              const DescentOptions& options);

}  // namespace chladni::identification
