// Small causes that the tolerances hide from a scene.
#pragma once

#include <vector>

#include "diagnosis/fit.h"

namespace chladni::diagnosis {

/// A cause of a size that would take much of what a fit leaves.
struct Hint {
  Supposed cause;
  double fall = 0.0;  ///< of χ² and the tolerances' ηᵀη together, to first order
};

/// The score test (Rao, Proc. Camb. Phil. Soc. 44, 1948) of every effect that has a size: with the
/// weighted slope g of the size, what the fit leaves r and the information F that the tolerances
/// leave, the size is gᵀr / F and the fall (gᵀr)² / F. A scene sees tolerances as noise of each
/// response by itself and is blind to what is smaller; this knows how they go together, but is of
/// first order: for what is small.
/// Those that fall by more than `least`, the largest first, the best of each effect and choice.
/// Cost: a slope per deviation and some hundred more, N (deviations)².
[[nodiscard]] std::vector<Hint> hints(const Problem& problem, const Fit& about,
                                      const std::vector<const Effect*>& catalogue, double least);

}  // namespace chladni::diagnosis
