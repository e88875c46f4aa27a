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

/// True if there are four channels or more, and the modes of the responses scatter about the
/// simulated ones by more than the tolerance of a frequency, or most of them are like none of
/// these: by errors of the model or by a cause, which only their diagnosis tells apart.
[[nodiscard]] bool has_other_modes(const Diagnosed& one,
                                   const diagnosis::DiagnosisOptions& options);

/// Diagnoses the modes of the responses and sets `by_modes`.
/// @param modes  of the responses; none, or known levels: nothing is done
void diagnose_modes(Diagnosed& one, const std::optional<diagnosis::MeasuredModes>& modes,
                    const diagnosis::DiagnosisOptions& options, stage::Work& work);

/// True if the modes are diagnosed, and the model is less good than the tolerances say whatever
/// their cause is (diagnosis::are_beyond).
[[nodiscard]] bool is_less_good(const Diagnosed& one, const diagnosis::DiagnosisOptions& options);

/// How the responses are diagnosed after their modes. Where these say that the model is less good
/// than the tolerances whatever the cause is, hardly any cause explains the responses within these:
/// then a first look tells whether one cause, which modes may not show, explains much.
[[nodiscard]] diagnosis::DiagnosisOptions beside_modes(const Diagnosed& one,
                                                       diagnosis::DiagnosisOptions options);

/// The options with the model's errors as the modes show them, where theirs is the answer and the
/// tolerances are too narrow: what an experiment finds beside such a model.
[[nodiscard]] diagnosis::DiagnosisOptions beside_errors(const Diagnosed& one,
                                                        diagnosis::DiagnosisOptions options);

/// True if a first look leaves the responses explained, or one cause takes so much of their misfit
/// that a search is worth its time.
[[nodiscard]] bool is_promising(const Diagnosed& one);

/// True if the responses are not explained: `partial` or `unexplained`.
[[nodiscard]] bool is_open(const Diagnosed& one);

/// The result after both diagnoses. Where the responses are not explained within the stated
/// tolerances, causes that the modes name are the answer, and where the model is less good than
/// these whatever the modes say is. Of the notes, those on the data then stay.
void take_answer_of_modes(Diagnosed& one, const diagnosis::DiagnosisOptions& options);

/// Causes named by the modes of the responses are not believed if the study with them predicts the
/// responses no better: the verdict is then `unexplained`, and no probability is above a half.
void believe_what_pays(Diagnosed& one);

/// The calibrated constants that the data determine, in the form of causes.
[[nodiscard]] std::vector<diagnosis::Cause> constants_as_causes(const diagnosis::Diagnosis& result);

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
