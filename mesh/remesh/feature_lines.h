// Fewer points on the lines along which the parts of a surface meet.
#pragma once

#include <vector>

#include "mesh/soundness/shells.h"
#include "mesh/surface.h"

namespace chladni::mesh {

/// What a chord may replace of a line.
struct Sampling {
  double longest = 0.0;    ///< its length [m]
  double deviation = 0.0;  ///< its distance from the points it leaves out [m]
  double turn = 0.0;       ///< the angle by which the line turns over it [rad]
};

/// The length of chord that a curve of `radius` [m] gets [m].
[[nodiscard]] double chord_length(double radius, const Sampling& sampling);

/// Per point the one that stands for it. Only points inside of a line of the `kept` edges are
/// replaced, by the nearest one of their line that stays: ends, branches and corners of more than
/// 50 degrees do. What stays is spread evenly. Cost: n log n, times the points under a chord.
[[nodiscard]] std::vector<int> stand_ins(const Surface& surface, const std::vector<EdgeUse>& kept,
                                         const Sampling& sampling);

}  // namespace chladni::mesh
