// What a study's simulation gets wrong, why, and what naming it gains.
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
  modal::FrfSet seen;     ///< without what was held out
  Solution before;        ///< of the study, with as many modes as a diagnosis needs
  diagnosis::Structure structure;
  diagnosis::Comparison comparison;
  diagnosis::Diagnosis result;
  std::vector<diagnosis::Detectable> detectable;  ///< that the same experiment would find
  double least_evidence = 0.0;                    ///< DiagnosisPlan's
  std::optional<ExtendedStudy> extended;          ///< where a cause was named
  std::optional<Solution> after;                  ///< the extended study, solved in full
  Predictions predictions;                        ///< on `measured`
  Gain gain;
};

/// The measured responses, the study's structure, the comparison, the diagnosis, the extended study
/// solved again, the gain. Of causes that no study can express the gain is that of the reduced
/// model; an extended study that does not change, or cannot be solved, costs a note and no more.
/// @throws as its steps, but for those of the extended study
[[nodiscard]] Diagnosed diagnosed(const Study& study, Run& run);
/// The same with another way to solve the extended study.
using SolveStudy = std::function<Solution(const Study& study, Run& run)>;
[[nodiscard]] Diagnosed diagnosed(const Study& study, Run& run, const SolveStudy& solve_extended);

[[nodiscard]] std::string diagnosis_table(const Diagnosed& diagnosed);
[[nodiscard]] io::JsonObject diagnosis_json(const Diagnosed& diagnosed);
/// What not to act on and why, where it is so; then the verdict.
[[nodiscard]] std::string verdict_text(const Diagnosed& diagnosed);
/// The verdict in a sentence.
[[nodiscard]] std::string verdict_text(const diagnosis::Diagnosis& result);
/// Where the responses after come from, a line each.
[[nodiscard]] std::vector<std::string> gain_lines(const Gain& gain);
/// "point_mass: 0.2518 +- 0.0001 kg at (127.8, -289.9) mm"
[[nodiscard]] std::string cause_text(const diagnosis::Cause& cause);

/// Verdict, causes, where, what it gains, the modes: a section of the report.
[[nodiscard]] io::Section diagnosis_section(const Diagnosed& diagnosed, const Run& run);

/// diagnosis.json, extended.toml, cause_map.vtu and .png, prediction.png
void leave_diagnosis(const Study& study, const Diagnosed& diagnosed, Run& run, bool main_result);

}  // namespace chladni::app
