// A diagnosis as text, JSON, a section of the report and files.
#pragma once

#include "io/report.h"
#include "io/result_table.h"
#include "show/run.h"
#include "steps/diagnosis.h"

namespace chladni::show {

/// "point_mass: 0.2518 +- 0.0001 kg at (127.8, -289.9) mm"
[[nodiscard]] std::string cause_text(const diagnosis::Cause& cause);

/// The causes of the best explanation with their probability, evidence and part of the misfit.
[[nodiscard]] io::ResultTable causes_table(const diagnosis::Diagnosis& result);

/// A warning and its reason, if the result should not be used; then the verdict.
[[nodiscard]] std::string verdict_text(const steps::Diagnosed& diagnosed);

[[nodiscard]] io::JsonObject diagnosis_json(const steps::Diagnosed& diagnosed);

/// The verdict with its numbers and the next step; then the tables behind it.
/// @param all  false: without the table of what the experiment can find, and without the comparison
///             by mode, band and channel where the verdict explains the difference
[[nodiscard]] std::string diagnosis_table(const steps::Diagnosed& diagnosed, bool all = true);

/// A section of the report behind the verdict: causes, places, gain, responses, modes.
/// @param run  has painted its pictures; null: it has none
[[nodiscard]] io::Section diagnosis_section(const steps::Diagnosed& diagnosed, const Run* run);

/// True if a fit used the measured response of output i and input j.
[[nodiscard]] bool is_fitted(const steps::Diagnosed& diagnosed, Eigen::Index i, Eigen::Index j);

/// diagnosis.json, extended.toml, cause_map.vtu and .png; of responses also prediction.png,
/// errors_over_frequency.png and mac.png
void leave_diagnosis(const study::Study& study, const steps::Diagnosed& diagnosed, Run& run,
                     bool main_result);

/// The verdict in a sentence.
[[nodiscard]] std::string verdict_text(const diagnosis::Diagnosis& result);

}  // namespace chladni::show
