// How wide a band must be to hold what it says.
#pragma once

#include <functional>

#include "priors/interpolator.h"

namespace chladni::priors {

/// A fit of measured shapes, by whatever method.
using Fitting = std::function<std::unique_ptr<ModeField>(const MeasuredShapes&)>;

/// The factor on the deviations of a fit with which its 95 % bands hold 95 % of values that it has
/// not seen: the places are left out in four parts, each predicted from the others, all shapes
/// together. Within [0.75, 4]; 1 with fewer than eight places. Cost: four fits, on all cores.
/// What no place sees it cannot know.
[[nodiscard]] double band_factor(const MeasuredShapes& measured, const Fitting& fit);

}  // namespace chladni::priors
