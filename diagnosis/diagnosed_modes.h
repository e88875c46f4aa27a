// Why a simulation disagrees with measured modes: causes with their probabilities, beside a
// model-form error whose levels are inferred.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/measured_modes.h"

namespace chladni::diagnosis {

/// The tolerances are what is usual for a model of this kind, not a limit: the levels of the
/// model's errors are inferred under each hypothesis (DiagnosisOptions::levels). A cause is named
/// with its probability against all others, against scatter of that level, and against a mode or a
/// channel that is not believed.
///
/// Channels are matched by name; those that the structure lacks are left out with a note. An effect
/// that does not change modes (a residual flexibility, a drift) is not looked for.
/// Source: MacKay, Neural Computation 4 (1992) for the levels; Kennedy and O'Hagan, J. R. Stat.
/// Soc. B 63 (2001) for model-form error beside parameters.
/// Cost: 1 to 3 s on two cores for 12 modes at 17 channels.
/// @throws InvalidInput  as check(MeasuredModes); no mode of the structure near those measured
[[nodiscard]] Diagnosis diagnosed(const Structure& structure, const MeasuredModes& measured,
                                  const DiagnosisOptions& options = {});

}  // namespace chladni::diagnosis
