// Calibration of the width of uncertainty bands.
#pragma once

#include <functional>

#include "priors/interpolator.h"

namespace chladni::priors {

/// A fit of measured shapes by any method.
using Fitting = std::function<std::unique_ptr<ModeField>(const MeasuredShapes&)>;

/// The factor on a fit's deviations with which its 95 % bands contain 95 % of unseen values. The
/// places are left out in four parts; each part is predicted from the others, all shapes together.
/// Which place is in which part follows from how much it moves, not from the order of the places.
/// Within [0.75, 4]; 1 with fewer than eight places. Cost: four fits, on all cores. Errors that no
/// place sees stay unknown.
[[nodiscard]] double band_factor(const MeasuredShapes& measured, const Fitting& fit);

}  // namespace chladni::priors
