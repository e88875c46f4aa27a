// Minimum distance between sites.
#pragma once

#include <algorithm>
#include <vector>

#include "base/arrays.h"

namespace chladni::placement {

/// Whether sites a and b exclude each other. @param position  N×3 [m]; may be
/// empty if `spacing` is 0
[[nodiscard]] inline bool too_near(const Points& position, double spacing, Eigen::Index a,
                                   Eigen::Index b) {
  if (a == b) return true;
  return spacing > 0.0 && (position.row(a) - position.row(b)).norm() < spacing * (1.0 - 1e-9);
}

/// Whether `candidate` may join `sites`.
[[nodiscard]] inline bool fits(const Points& position, double spacing,
                               const std::vector<Eigen::Index>& sites, Eigen::Index candidate) {
  return std::none_of(sites.begin(), sites.end(), [&](Eigen::Index site) {
    return too_near(position, spacing, site, candidate);
  });
}

}  // namespace chladni::placement
