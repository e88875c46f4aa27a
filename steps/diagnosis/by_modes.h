// Diagnosis of measured modes, as a part of the diagnosis of a study.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/calibrated_responses.h"
#include "identification/modal_fit.h"
#include "steps/diagnosis.h"

namespace chladni::steps {

[[nodiscard]] diagnosis::DiagnosisOptions options_of(const study::DiagnosisPlan& plan,
                                                     stage::Work& work);

/// The constants of the study, with the directions of the chart that its material's axes have. The
/// material's axes are those of the body.
[[nodiscard]] std::vector<diagnosis::CalibratedConstant> constants_of(
    const study::Study& study, const diagnosis::Surface& chart);

/// Where the fits of the responses start: their modes, and the study's constants at which these fit
/// best without a cause. A note tells of constants without modes.
/// @param scaled  the responses have a known scale
[[nodiscard]] diagnosis::FitStart start_by_modes(const Diagnosed& one, bool scaled,
                                                 const diagnosis::DiagnosisOptions& options,
                                                 stage::Work& work);

/// Diagnoses the modes of the responses, where the responses are not explained to the noise and the
/// levels of the model's errors are learned. Sets `by_modes` and, if it names causes, the result.
/// @param modes  of the responses; none: nothing is done
void diagnose_modes_of_responses(Diagnosed& one,
                                 const std::optional<diagnosis::MeasuredModes>& modes,
                                 const diagnosis::DiagnosisOptions& options, stage::Work& work);

/// Causes named by the modes of the responses are not believed if the study with them predicts the
/// responses no better: the verdict is then `unexplained`, and no probability is above a half.
void believe_what_pays(Diagnosed& one);

/// The causes that belong into the extended study: all of responses; of modes, those that are
/// likelier than not. Before them the constants that were calibrated. None where the verdict is
/// `unexplained`.
[[nodiscard]] std::vector<diagnosis::Cause> causes_to_extend(const Diagnosed& one);

/// Measured modes of a study's file, and those of its reference.
struct ModesOfFiles {
  diagnosis::MeasuredModes modes;
  std::optional<diagnosis::MeasuredModes> reference;
};
/// @throws InvalidInput  as measured_modes and reference_modes
[[nodiscard]] ModesOfFiles modes_of_files(const study::Study& study, stage::Work& work);

/// Frequencies alone have no MAC.
void drop_mac_without_shapes(Diagnosed& one);

/// The frequencies and shapes of the extended study, in finite elements, in place of those of the
/// reduced model. MACs stay those of the reduced model where a channel is a cause.
void retell_modes(const study::Study& extended, const stage::Solution& after,
                  const diagnosis::DiagnosisOptions& options, Diagnosed& one);

}  // namespace chladni::steps
