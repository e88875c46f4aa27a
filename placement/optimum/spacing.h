// Minimum distance between sites.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/arrays.h"
#include "base/error.h"

namespace chladni::placement {

/// @throws InvalidInput  not one position per candidate; without spacing there may be none
inline void require_positions(const Points& position, Eigen::Index candidates, double spacing) {
  const bool none = position.rows() == 0 && !(spacing > 0.0);
  require(none || position.rows() == candidates,
          "layout: there are " + fmt::to_string(candidates) + " candidates and " +
              fmt::to_string(position.rows()) + " positions; expected as many");
}

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
