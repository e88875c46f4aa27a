// Search for the best place near a good one.
#pragma once

#include <functional>

#include "placement/sites.h"

namespace chladni::placement {

/// The value of each of some sites; −∞ where no device may be.
using Worth = std::function<Eigen::VectorXd(const Sites& sites)>;

/// Climbs from `start` along the surface. Steps begin with `step` [m] and are halved down to
/// `tolerance`; each step tries eight neighbours. @returns one site, no worse than the start
/// @param faces  on which the site stays; null: all of the body
[[nodiscard]] Sites refined(const Sampler& sampler, const Sites& start, const Worth& worth,
                            double step, double tolerance, const FaceFinder* faces = nullptr);

}  // namespace chladni::placement
