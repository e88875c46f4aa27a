// Starts of the fit of a cause: the best ones that its effect offers, improved in a scene.
#pragma once

#include <vector>

#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {

struct Start {
  Supposed cause;
  double misfit = 0.0;  ///< χ², with the variances of the scene
};

/// At most two starts, of different choices or places. Starts of effects with a place are first
/// moved along one coordinate at a time if much is unexplained, because stiff or heavy attachments
/// have valleys narrower than the distance of the scan's places. Gauss-Newton steps follow. Cost: a
/// misfit per start that the effect offers, and up to a thousand cheap ones for effects with a
/// place.
[[nodiscard]] std::vector<Start> best_starts(const Scene& scene, const Effect& effect);

}  // namespace chladni::diagnosis
