#include "diagnosis/verdict/last_fits.h"

#include <algorithm>
#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/search/simpler.h"

namespace chladni::diagnosis {

SearchLimits limits_of(const Prepared& given, const DiagnosisOptions& options) {
  SearchLimits limits;
  limits.most_causes = options.most_causes;
  limits.least_evidence = options.least_evidence;
  limits.unseen = given.shapes;
  if (!options.is_look) return limits;
  limits.is_look = true;
  limits.most_causes = std::min(options.most_causes, 1);
  limits.fits_per_level = kConstants.look_fits;
  limits.fit_iterations = kConstants.look_iterations;
  return limits;
}

Found fitted_again(const Problem& problem, const Found& found) {
  const auto again = [&](const Fit& fit) {
    return fitted(problem, with_deviations(fit, problem.deviations.size()));
  };
  Found fine;
  const double best = found.fits.front().log_evidence;
  std::vector<const Fit*> taken;
  for (const auto& fit : found.fits) {
    if (fit.causes.empty()) continue;
    const bool close =
        best - fit.log_evidence < kConstants.occam_margin && taken.size() < kConstants.last_fits;
    const bool known = std::ranges::any_of(
        taken, [&](const Fit* other) { return alike(problem.structure, *other, fit); });
    if (known || !(close || &fit == &found.fits.front())) continue;
    taken.push_back(&fit);
    keep(fine.fits, again(fit));
  }
  fine.nothing = again(found.nothing);
  if (!fine.fits.empty()) fine.nothing = nothing_beside(problem, fine.nothing, fine.fits.front());
  keep(fine.fits, fine.nothing);
  return fine;
}

}  // namespace chladni::diagnosis
