// Diagnosis of responses with constants of the study that are not known.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/measured_modes.h"

namespace chladni::diagnosis {

/// Where the fits of responses start. Responses tell nothing of what is some bandwidths off in
/// frequency, but their modes do.
struct FitStart {
  /// As the modes of the responses have them (diagnosed_modes.h). The prior of a constant has its
  /// stated width about this value. One that is not here, or not determined, starts at the study's
  /// value.
  std::vector<CalibratedNumber> constants;
  /// Modes of the responses: the fit of the tolerances alone is also made from the deviations that
  /// these modes have. A note tells where that ends elsewhere.
  std::optional<MeasuredModes> modes;
};

/// As diagnosed(structure, measured, options), with `options.constants` calibrated in every
/// hypothesis, also where nothing is wrong.
/// @throws as diagnosed; InvalidInput  a constant without an effect, stated twice, or with a
///                       deviation that is not above 0
[[nodiscard]] Diagnosis diagnosed(const Structure& structure, const modal::FrfSet& measured,
                                  const DiagnosisOptions& options, const FitStart& start);

}  // namespace chladni::diagnosis
