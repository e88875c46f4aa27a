// Measured responses as a diagnosis takes them.
#pragma once

#include <optional>

#include "diagnosis/measured_modes.h"
#include "identification/modal_fit.h"
#include "modal/frf_set.h"
#include "stage/work.h"
#include "steps/identification.h"
#include "study/study.h"

namespace chladni::steps {

/// That of the study, or the usual one.
[[nodiscard]] study::DiagnosisPlan plan_of(const study::Study& study);

/// The responses for a diagnosis: receptances within the band, below the last mode at `highest_hz`,
/// with variances: estimated where the file states none, of neighbouring lines where one is 0. A
/// response of 0 beside a variance of 0 was not measured, on single lines or on all. Notes count
/// both.
/// @throws InvalidInput  fewer than 16 lines are left, or fit_data refuses the variances
[[nodiscard]] MeasuredFrfs within_band(MeasuredFrfs measured, const study::Study& study,
                                       const study::DiagnosisPlan& plan, double highest_hz,
                                       stage::Work& work);

/// Modes of the measured responses, for the comparison; none if they cannot be identified.
/// @param variance_stated  MeasuredFrfs::variance_stated: else the fit allows for an error of the
///                         model, as an identification does
[[nodiscard]] std::optional<identification::ModalFit> modes_of(const modal::FrfSet& seen,
                                                               bool variance_stated,
                                                               const study::Study& study,
                                                               stage::Work& work);

/// The modes of a fit that are no filling of it: with a tenth of the largest residue in some
/// response, and damped at most three times as much as the median of those. A note tells of others.
/// @throws InvalidInput  the fit has no mode
[[nodiscard]] diagnosis::MeasuredModes clear_modes(const diagnosis::MeasuredModes& all,
                                                   stage::Work& work);

}  // namespace chladni::steps
