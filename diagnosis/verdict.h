// From fits to what is said: names, places, sizes, probabilities.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/search.h"

namespace chladni::diagnosis {

/// Same causes with the same choices, places within three deviations or a tenth of the surface's
/// size.
[[nodiscard]] bool alike(const Structure& structure, const Fit& a, const Fit& b);

/// Found fits as explanations, each once, with probabilities among them: evidence divided by
/// χ²/N of the best where it leaves more than noise, so that what nobody explains makes nobody
/// sure. Of two within `equal` of evidence the simpler comes first.
[[nodiscard]] std::vector<Explanation> explanations(const Problem& problem, const Found& found,
                                                    double equal);

/// The verdict on them; `explanations.front()` is the best.
[[nodiscard]] Verdict judged(const Problem& problem, const Found& found,
                             const std::vector<Explanation>& explanations,
                             const DiagnosisOptions& options);

/// χ² per number of what a fit leaves.
[[nodiscard]] Residue residue(const Problem& problem, const Fit& fit);

}  // namespace chladni::diagnosis
