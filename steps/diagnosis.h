// Diagnosis of a study: what its simulation gets wrong, why, and the gain of naming it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/detectable.h"
#include "diagnosis/diagnosed.h"
#include "stage/solution.h"
#include "steps/compared.h"
#include "steps/extend/extended_study.h"

namespace chladni::steps {

/// A comparison and what explains it. Where modes alone were measured, `detectable` and `gain` are
/// empty.
struct Diagnosed : Compared {
  diagnosis::Diagnosis result;
  std::optional<diagnosis::MeasuredModes> reference;  ///< modes before, if the study names a file
  std::string reference_file;                         ///< its name, without the folder
  /// Diagnosis of the modes of the responses: where these scatter about the simulated ones, or the
  /// responses are not explained to the noise. is_of_modes() tells whether it is the answer.
  std::optional<diagnosis::Diagnosis> by_modes;
  std::vector<diagnosis::Detectable> detectable;  ///< detectable effects of the same experiment
  double least_evidence = 0.0;                    ///< DiagnosisPlan::least_evidence
  std::optional<ExtendedStudy> extended;          ///< if a cause was named
  std::optional<stage::Solution> after;           ///< the extended study, solved in full
  /// Modes of `seen`; none: they were not identified.
  std::optional<identification::ModalFit> identified;
  std::vector<diagnosis::ModeTold> modes_compared;  ///< these, before and in the extended study
  ErrorsOverFrequency errors;                       ///< of `predictions`
  Gain gain;
};

/// True if verdict and causes are those of modes: of a file, or of the responses.
[[nodiscard]] inline bool is_of_modes(const Diagnosed& one) { return !one.result.modes.empty(); }

/// Levels that the data determine, in words: {"frequencies", "0.8 %"}, {"shapes", "5 %"}.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> told_levels(
    const std::vector<diagnosis::ErrorLevel>& levels);

/// Reads the measured responses or modes, makes the structure and the comparison, diagnoses, solves
/// the extended study again, and computes the gain. For causes that no study can express, the gain
/// is that of the reduced model. If the extended study does not change or cannot be solved, there
/// is only a note.
/// @throws as its steps, except those of the extended study
[[nodiscard]] Diagnosed diagnosed(const study::Study& study, stage::Work& work);
/// The same for a study that is solved, with the modes that a diagnosis needs
/// (stage::kDiagnosisModes).
[[nodiscard]] Diagnosed diagnosed(const study::Study& study, stage::Solution before,
                                  stage::Work& work);
/// The same with another function that solves the extended study.
using SolveStudy = std::function<stage::Solution(const study::Study& study, stage::Work& work)>;
[[nodiscard]] Diagnosed diagnosed(const study::Study& study, stage::Work& work,
                                  const SolveStudy& solve_extended);

}  // namespace chladni::steps
