// Diagnosis of a study: what its simulation gets wrong, why, and the gain of naming it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/stage/solution.h"
#include "app/steps/diagnosis_gain.h"
#include "app/steps/identification.h"
#include "app/study/extend/extended_study.h"
#include "diagnosis/compare.h"
#include "diagnosis/detectable.h"
#include "diagnosis/diagnosed.h"
#include "io/report.h"

namespace chladni::app {

struct Diagnosed {
  MeasuredFrfs measured;  ///< receptances within the band, all channels of the study
  modal::FrfSet seen;     ///< without the held-out channels and lines
  Solution before;        ///< solution of the study, with enough modes for a diagnosis
  diagnosis::Structure structure;
  diagnosis::Comparison comparison;
  diagnosis::Diagnosis result;
  std::vector<diagnosis::Detectable> detectable;  ///< detectable effects of the same experiment
  double least_evidence = 0.0;                    ///< DiagnosisPlan::least_evidence
  std::optional<ExtendedStudy> extended;          ///< if a cause was named
  std::optional<Solution> after;                  ///< the extended study, solved in full
  Predictions predictions;                        ///< on `measured`
  Gain gain;
};

/// Reads the measured responses, makes the structure and the comparison, diagnoses, solves the
/// extended study again, and computes the gain. For causes that no study can express, the gain is
/// that of the reduced model. If the extended study does not change or cannot be solved, there is
/// only a note.
/// @throws as its steps, except those of the extended study
[[nodiscard]] Diagnosed diagnosed(const Study& study, Run& run);
/// The same with another function that solves the extended study.
using SolveStudy = std::function<Solution(const Study& study, Run& run)>;
[[nodiscard]] Diagnosed diagnosed(const Study& study, Run& run, const SolveStudy& solve_extended);

[[nodiscard]] std::string diagnosis_table(const Diagnosed& diagnosed);
[[nodiscard]] io::JsonObject diagnosis_json(const Diagnosed& diagnosed);
/// A warning and its reason, if the result should not be used; then the verdict.
[[nodiscard]] std::string verdict_text(const Diagnosed& diagnosed);
/// The verdict in a sentence.
[[nodiscard]] std::string verdict_text(const diagnosis::Diagnosis& result);
/// Origin of the responses after the diagnosis, one line each.
[[nodiscard]] std::vector<std::string> gain_lines(const Gain& gain);
/// "point_mass: 0.2518 +- 0.0001 kg at (127.8, -289.9) mm"
[[nodiscard]] std::string cause_text(const diagnosis::Cause& cause);

/// A section of the report: verdict, causes, places, gain, modes.
[[nodiscard]] io::Section diagnosis_section(const Diagnosed& diagnosed, const Run& run);

/// diagnosis.json, extended.toml, cause_map.vtu and .png, prediction.png
void leave_diagnosis(const Study& study, const Diagnosed& diagnosed, Run& run, bool main_result);

}  // namespace chladni::app
