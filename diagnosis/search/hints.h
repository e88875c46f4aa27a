// Small causes that the widened variances of a scene hide.
#pragma once

#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// A cause at a size that removes much of the residual of a fit.
struct Hint {
  Supposed cause;
  double log_evidence = 0.0;  ///< relative to the fit, to first order, for a known place
};

struct HintLimits {
  double least_evidence = kConstants.least_evidence;
  double times = 1.0;  ///< measured numbers of the full data over those of the problem
};

/// The score test (Rao, Proc. Camb. Phil. Soc. 44, 1948) of every effect that has a size. With the
/// score s of the size and the information F that the tolerances leave (information.h), the size is
/// s / F. The penalised misfit χ² + ηᵀη falls by s² / F. A scene treats tolerances as independent
/// noise of each response, so it cannot see smaller effects. The score test uses the correlations
/// of the tolerances, but it is of first order: for small effects. The result has the hints that
/// may bring the evidence, the most promising first, the best one of each effect and choice. Cost:
/// a slope per deviation and some hundred more, N (deviations)².
[[nodiscard]] std::vector<Hint> hints(const Problem& problem, const Fit& about,
                                      const std::vector<const Effect*>& catalogue,
                                      const HintLimits& limits = {});

}  // namespace chladni::diagnosis
