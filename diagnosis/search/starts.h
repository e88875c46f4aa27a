// Where the fit of a cause begins: the best of what its effect offers, improved in a scene.
#pragma once

#include <vector>

#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {

struct Start {
  Supposed cause;
  double misfit = 0.0;  ///< χ², widened as the scene's
};

/// At most two, of different choices or places. Those of effects that hang somewhere are first
/// moved along one coordinate at a time where much is unexplained: what is stiff or heavy has
/// valleys narrower than the scan's places are apart. Then Gauss and Newton.
/// Cost: a misfit per start the effect offers, a thousand cheap ones more where one hangs.
[[nodiscard]] std::vector<Start> best_starts(const Scene& scene, const Effect& effect);

}  // namespace chladni::diagnosis
