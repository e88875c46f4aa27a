// The scale of a body, for priors and steps of lengths.
#pragma once

#include "diagnosis/structure.h"

namespace chladni::diagnosis {

/// Longest side of the box around the body on its chart, in 600 mm; without cells, of the box
/// around the places of the surface and of the channels. Lengths in priors, starts and steps are
/// those of a body of 600 mm times this factor.
[[nodiscard]] double body_scale(const Structure& structure);

/// [m]: step of a place or an offset for finite differences.
[[nodiscard]] inline double place_step(const Structure& structure) {
  return 1e-5 * body_scale(structure);
}

}  // namespace chladni::diagnosis
