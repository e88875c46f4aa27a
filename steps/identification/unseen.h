// How well an identified model predicts data that its fit has not seen.
#pragma once

#include <functional>
#include <optional>

#include "steps/identification.h"

namespace chladni::steps {

/// A fit of other data by the way, and with the modes, of the model.
using Refit = std::function<identification::ModalFit(const identification::FitData&)>;

/// The parts of the recordings in turn: fitted without one, which is then predicted. None where the
/// recordings have no such parts, or a fit fails or is stopped, which is told.
/// Cost: one fit per part, from the poles of the model.
[[nodiscard]] std::optional<identification::CrossValidation> cross_validated(
    const study::Study& study, const IdentifiedModel& model, const Refit& refit, stage::Work& work);

/// The responses of `[measurement] validation`, before the fit of the others; none where the study
/// names no such file.
/// @param model  with the data of the fit
/// @throws InvalidInput  as measured_frfs; the file lacks a channel of the fit, or has fewer than 9
///                       lines in its band
[[nodiscard]] std::optional<SecondRecord> read_second_record(const study::Study& study,
                                                             const IdentifiedModel& model,
                                                             stage::Work& work);
/// Scores what the fitted model predicts of its second record.
/// @throws InvalidInput  as identification::fit_data
void score_second_record(const study::Study& study, IdentifiedModel& model);

}  // namespace chladni::steps
