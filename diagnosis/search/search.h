// Which causes explain the data: one more at a time, with rivals kept, then fewer.
#pragma once

#include <vector>

#include "base/progress.h"
#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

struct SearchLimits {
  int most_causes = 3;
  int fits_per_level = 5;       ///< full fits of what looks best from a scene
  int lines_of_scene = 120;     ///< at most: for a first look
  int beam = 2;                 ///< explanations that are carried to the next level, at most,
  double beam_within = 20.0;    ///< and their log evidence of the best
  double least_evidence = 8.0;  ///< ln of the Bayes factor of one more cause
  double least_share = 0.01;    ///< of what all causes gain, or the cause is dropped,
  double least_excess = 5.0;    ///< unless this much (z) is left without it,
  double sure_evidence = 12.0;  ///< or its own evidence is this high, and above the errors of
                                ///< the others (Effect::error)
  /// Errors that the last word knows and the search takes for noise: what they may be is no hint.
  std::vector<Deviation> unseen = {};
};

struct Found {
  Fit nothing;            ///< the tolerances alone
  std::vector<Fit> fits;  ///< all that were fitted in full, descending evidence, `nothing` too
};

/// At each level, from the best explanations so far: every effect of the catalogue is tried at the
/// starts it offers, in a scene whose variances the tolerances widen; the best few are fitted in
/// full, and four that the score test hints at (hints.h), which sees what is small. It ends when
/// no cause brings `least_evidence`; where nothing is left to explain only the hints are fitted.
/// Then each cause is left out in turn, and stays out where that costs too little.
/// @param catalogue  the effects that may be
[[nodiscard]] Found searched(const Problem& problem, const std::vector<const Effect*>& catalogue,
                             const SearchLimits& limits, const Progress& progress = {});

}  // namespace chladni::diagnosis
