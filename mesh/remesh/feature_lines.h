// Thins out the points on the lines along which the parts of a surface meet.
#pragma once

#include <vector>

#include "mesh/soundness/shells.h"
#include "mesh/surface.h"

namespace chladni::mesh {

/// Limits on the piece of a line that one chord may replace.
struct Sampling {
  double longest = 0.0;    ///< length of the chord [m]
  double deviation = 0.0;  ///< distance of the chord from the points it leaves out [m]
  double turn = 0.0;       ///< angle by which the line turns over the chord [rad]
};

/// The chord length for a curve of `radius` [m] [m].
[[nodiscard]] double chord_length(double radius, const Sampling& sampling);

/// For each point, the point that replaces it. Only inner points of a line of `kept` edges are
/// replaced, by the nearest remaining point of the line. Ends, branches and corners of more than 50
/// degrees always remain. The remaining points are evenly spread. Cost: n log n, times the points
/// under a chord.
[[nodiscard]] std::vector<int> stand_ins(const Surface& surface, const std::vector<EdgeUse>& kept,
                                         const Sampling& sampling);

}  // namespace chladni::mesh
