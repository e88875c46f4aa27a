// Search for the causes that explain the data: causes are added one by one, then reduced.
#pragma once

#include <vector>

#include "base/progress.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

struct SearchLimits {
  /// Causes that the search adds, at most. Readings of channels (readings.h) do not count: they are
  /// put right before, and any number of channels may be read in a wrong way.
  int most_causes = kConstants.most_causes;
  int fits_per_level = kConstants.fits_per_level;  ///< fits in full per explanation
  int lines_of_scene = kConstants.lines_of_scene;  ///< at most, for a first look
  int beam = kConstants.beam;                      ///< explanations carried to the next level
  double beam_within = kConstants.beam_within;  ///< distance in ln evidence from the best of these
  /// ln of the Bayes factor that one more cause needs.
  double least_evidence = kConstants.least_evidence;
  /// A cause stays if it brings this part of the total gain.
  double least_share = kConstants.least_share;
  /// A cause stays if this excess z is left without it.
  double least_excess = kConstants.least_excess;
  /// A cause stays with this evidence, if that also exceeds the errors of the others
  /// (Effect::error).
  double sure_evidence = kConstants.sure_evidence;
  /// Errors that are noise in the search and parameters in the final fit. An effect that they can
  /// explain gives no hint.
  std::vector<Deviation> unseen = {};
  int fit_iterations = kConstants.quick_iterations;  ///< of a candidate
  bool is_look = false;  ///< candidates of the scene alone: no hints, other places or free gains
};

struct Found {
  Fit nothing;            ///< fit of the tolerances alone
  std::vector<Fit> fits;  ///< all fits in full, descending evidence, with `nothing`
  /// [ln] Objective of the fit of the tolerances alone from the simulation, minus that from the
  /// given start. 0: there was none.
  double by_start = 0.0;
};

/// Starts at each level from the best explanations so far. Every effect of the catalogue is tried
/// at its starts in a scene, whose variances the tolerances widen. The best few are fitted in full,
/// and also up to four hints of the score test (hints.h), which sees small effects. The levels end
/// when no cause brings `least_evidence`. If only noise is left, only the hints are fitted. With
/// two or more causes, each is then exchanged or left out in turn, and stays out if that costs too
/// little. A look (SearchLimits::is_look) ends after the levels.
/// @param catalogue  the effects that are tried
/// @param start  deviations from which the fit of the tolerances alone is made a second time, as
///               deviations_by_modes gives them; the better fit is kept. Empty: none
[[nodiscard]] Found searched(const Problem& problem, const std::vector<const Effect*>& catalogue,
                             const SearchLimits& limits, const Progress& progress = {},
                             const Eigen::VectorXd& start = {});

}  // namespace chladni::diagnosis
