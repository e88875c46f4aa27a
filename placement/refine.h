// The best place near a good one.
#pragma once

#include <functional>

#include "placement/sites.h"

namespace chladni::placement {

/// How good each of some sites is; −∞ where nothing may be.
using Worth = std::function<Eigen::VectorXd(const Sites& sites)>;

/// Climbs from `start` along the surface by steps that begin with `step` [m] and are halved down to
/// `tolerance`: eight neighbours each time. @returns one site, no worse than the start
[[nodiscard]] Sites refined(const Sampler& sampler, const Sites& start, const Worth& worth,
                            double step, double tolerance);

}  // namespace chladni::placement
