// The places where devices may be.
#pragma once

#include <vector>

#include "placement/rules.h"
#include "placement/sites.h"

namespace chladni::placement {

/// A mounting grid seen from above.
struct Grid {
  Eigen::Vector2d pitch = Eigen::Vector2d::Zero();   ///< [m]
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
  int columns = 0, rows = 0;                         ///< along x and y
};

/// Its places (x, y), column by column [m].
[[nodiscard]] std::vector<Eigen::Vector2d> places_of(const Grid& grid);

/// Allowed places of devices.
struct Candidates {
  Sites sites;
  bool is_grid = false;          ///< no device may be beside them
  std::vector<char> faces = {};  ///< per boundary face 1 where a device may be; empty: on all
};
/// The points of a surface that no rule forbids, each place once even where patches meet.
/// @throws InvalidInput  as `admissible`
[[nodiscard]] Candidates candidates_on(const Surface& surface, const std::vector<Rule>& rules);
/// The places of a grid on the faces of a surface that no rule forbids: straight below or above
/// them, the highest where there are several.
/// @throws InvalidInput  none lies on the surface; as `admissible`
[[nodiscard]] Candidates candidates_on(const Grid& grid, const Sampler& sampler,
                                       const Surface& surface, const std::vector<Rule>& rules);

}  // namespace chladni::placement
