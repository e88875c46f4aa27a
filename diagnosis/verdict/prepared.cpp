#include "diagnosis/verdict/prepared.h"

#include <numbers>
#include <utility>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {

Observed Prepared::for_search(int lines) const {
  return thinned(widened(observed, model_variance(observed, response)), lines);
}

std::vector<Deviation> Prepared::all_deviations() const {
  auto deviating = tolerable;
  deviating.insert(deviating.end(), shapes.begin(), shapes.end());
  return deviating;
}

Prepared prepared(const Structure& structure, const modal::FrfSet& measured,
                  const Tolerances& tolerances) {
  const double last_hz = structure.frequency_hz(structure.mode_count() - 1);
  const double high_hz = kConstants.highest_line * last_hz;
  auto [own, observed, notes] = seen(structure, measured, high_hz);
  const double band_hz = observed.omega(observed.line_count() - 1) / (2.0 * std::numbers::pi);
  auto kept = std::make_shared<const Structure>(std::move(own));
  // Some hundredths of the contribution of modes above the band to it are loss. Their damping is
  // known to 20 % only, so this loss is more uncertain than the noise of thousands of lines.
  // Without dampings of their own the fit invented masses of -14 g.
  auto tolerable = deviations(*kept, tolerances, kConstants.own_frequencies * band_hz);
  auto shapes = shape_deviations(*kept, tolerances.response, kConstants.own_shapes * band_hz);
  // The effect of a cause on all modes is proportional to the square of the shapes at its place.
  // When the shapes at the channels were wrong by 0.1 %, masses, springs and tapers in models of
  // other elements were found with errors of 1 to 3 %. So cause_over_response is the ratio of the
  // two errors.
  return {std::move(kept),
          std::move(observed),
          std::move(notes),
          std::move(tolerable),
          std::move(shapes),
          tolerances.response,
          kConstants.cause_over_response * tolerances.response};
}

}  // namespace chladni::diagnosis
