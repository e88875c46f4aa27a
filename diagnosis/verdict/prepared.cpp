#include "diagnosis/verdict/prepared.h"

#include <numbers>
#include <utility>

#include "diagnosis/constants.h"
#include "diagnosis/verdict/constants_fitted.h"

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

Calibration calibration_of(const Structure& structure, const DiagnosisOptions& options,
                           const std::vector<CalibratedNumber>& start) {
  Calibration calibration;
  calibration.constants =
      held_constants(structure, options.constants, options.tolerances, calibration.notes);
  calibration.start = start_of(calibration.constants, start);
  return calibration;
}

Prepared prepared_with(const Structure& structure, const modal::FrfSet& measured,
                       const DiagnosisOptions& options, const Calibration& calibration) {
  auto given = prepared(structure, measured,
                        tolerances_left(calibration.constants, options.tolerances).tolerances);
  for (auto& constant :
       constant_deviations(*given.structure, calibration.constants, calibration.start)) {
    given.tolerable.push_back(std::move(constant));
  }
  return given;
}

}  // namespace chladni::diagnosis
