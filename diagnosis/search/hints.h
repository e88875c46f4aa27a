// Small causes that the tolerances hide from a scene.
#pragma once

#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// A cause of a size that would take much of what a fit leaves.
struct Hint {
  Supposed cause;
  double log_evidence = 0.0;  ///< over the fit, to first order, as if its place were known
};

struct HintLimits {
  double least_evidence = 8.0;
  double times = 1.0;  ///< as many numbers as the problem has are there to be explained
};

/// The score test (Rao, Proc. Camb. Phil. Soc. 44, 1948) of every effect that has a size: with the
/// score s of the size and the information F that the tolerances leave (information.h), the size is
/// s / F, and χ² and the tolerances' ηᵀη fall by s² / F together. A scene sees tolerances as noise
/// of each response by itself and is blind to what is smaller; this knows how they go together, but
/// is of first order: for what is small. Those that may bring the evidence, the most promising
/// first, the best of each effect and choice. Cost: a slope per deviation and some hundred more, N
/// (deviations)².
[[nodiscard]] std::vector<Hint> hints(const Problem& problem, const Fit& about,
                                      const std::vector<const Effect*>& catalogue,
                                      const HintLimits& limits = {});

}  // namespace chladni::diagnosis
