// Fewer candidates that cover the same surface.
#pragma once

#include <vector>

#include "base/arrays.h"

namespace chladni::placement {

/// `count` candidates, each the farthest from the earlier ones, beginning with the first.
/// Cost: N per candidate.
[[nodiscard]] std::vector<Eigen::Index> thinned(const Points& position, Eigen::Index count);

/// The farthest that a candidate is from its nearest coarse one, times Constants::coarse_reach [m].
[[nodiscard]] double reach_of(const Points& position, const std::vector<Eigen::Index>& coarse);

/// 0 to count − 1.
[[nodiscard]] std::vector<Eigen::Index> all_of(Eigen::Index count);

}  // namespace chladni::placement
