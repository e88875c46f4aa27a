// What dashpots at single places add to the damping ratio of one mode.
#pragma once

#include "base/turn.h"
#include "modal/reduced_model.h"

namespace chladni::modal {

/// |√c φ|² / 2ω of a flexible mode, whose coupling to the others is left out; 0 without dashpots.
/// Cost: the number of dashpots.
[[nodiscard]] inline double dashpot_ratio(const ReducedModel& model, Eigen::Index mode) {
  if (model.damper_count() == 0) return 0.0;  // their shapes may be of no mode then
  return model.dampers.shapes.col(mode).squaredNorm() / (2.0 * kTwoPi * model.frequency_hz(mode));
}

}  // namespace chladni::modal
