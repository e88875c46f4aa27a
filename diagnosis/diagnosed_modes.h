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

/// @throws InvalidInput  as check(MeasuredModes); both have sensors, and none in common; no mode in
///                       common, by frequency and shape
void check_reference(const MeasuredModes& measured, const MeasuredModes& reference);

/// Why measured modes differ from those of a reference, measured before something changed: a cause
/// is what only the later ones need. The structure is corrected to the reference
/// (modes/reference.h), so that the errors which its model has in both cancel. The levels are those
/// of two measurements of an unchanged structure, and the tolerances of the body are one
/// temperature. ModeTold::before_hz is a mode of the corrected structure.
/// Cost: as above.
/// @throws InvalidInput  as above and as check_reference; no mode of the structure is
///                       among those of the reference
[[nodiscard]] Diagnosis diagnosed(const Structure& structure, const MeasuredModes& measured,
                                  const MeasuredModes& reference, const DiagnosisOptions& options);

}  // namespace chladni::diagnosis
