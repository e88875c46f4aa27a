// Search for the causes that explain the data: causes are added one by one, then reduced.
#pragma once

#include <vector>

#include "base/progress.h"
#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

struct SearchLimits {
  int most_causes = 3;
  int fits_per_level = 5;       ///< fits in full per explanation, of the best candidates
  int lines_of_scene = 120;     ///< at most, for a first look
  int beam = 2;                 ///< explanations carried to the next level, at most
  double beam_within = 20.0;    ///< distance in ln evidence from the best of these
  double least_evidence = 8.0;  ///< ln of the Bayes factor that one more cause needs
  double least_share = 0.01;    ///< a cause stays if it brings this part of the total gain
  double least_excess = 5.0;    ///< a cause stays if this excess z is left without it
  double sure_evidence = 12.0;  ///< a cause stays with this evidence, if that also exceeds the
                                ///< errors of the others (Effect::error)
  /// Errors that are noise in the search and parameters in the final fit. An effect that they can
  /// explain gives no hint.
  std::vector<Deviation> unseen = {};
};

struct Found {
  Fit nothing;            ///< fit of the tolerances alone
  std::vector<Fit> fits;  ///< all fits in full, descending evidence, with `nothing`
};

/// Starts at each level from the best explanations so far. Every effect of the catalogue is tried
/// at its starts in a scene, whose variances the tolerances widen. The best few are fitted in full,
/// and also up to four hints of the score test (hints.h), which sees small effects. The levels end
/// when no cause brings `least_evidence`. If only noise is left, only the hints are fitted. With
/// two or more causes, each is then exchanged or left out in turn, and stays out if that costs too
/// little.
/// @param catalogue  the effects that are tried
[[nodiscard]] Found searched(const Problem& problem, const std::vector<const Effect*>& catalogue,
                             const SearchLimits& limits, const Progress& progress = {});

}  // namespace chladni::diagnosis
