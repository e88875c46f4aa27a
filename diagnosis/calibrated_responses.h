// Diagnosis of responses with constants of the study that are not known.
#pragma once

#include <vector>

#include "diagnosis/diagnosed.h"

namespace chladni::diagnosis {

/// As diagnosed(structure, measured, options), with `options.constants` calibrated in every
/// hypothesis, also where nothing is wrong. Responses tell nothing of a constant whose frequencies
/// are some bandwidths off, so the fits start at `start`: constants as the modes of the responses
/// have them (diagnosed_modes.h). The prior has its stated width about these values. Constants
/// that are not among `start`, or not determined, start at the study's value.
/// @throws as diagnosed; InvalidInput  a constant without an effect, stated twice, or with a
///                       deviation that is not above 0
[[nodiscard]] Diagnosis diagnosed(const Structure& structure, const modal::FrfSet& measured,
                                  const DiagnosisOptions& options,
                                  const std::vector<CalibratedNumber>& start);

}  // namespace chladni::diagnosis
