// What a study's simulation gets wrong, why, and what naming it gains.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/extended_study.h"
#include "app/identification.h"
#include "app/solution.h"
#include "diagnosis/compare.h"
#include "diagnosis/detectable.h"
#include "diagnosis/diagnosed.h"
#include "io/report.h"

namespace chladni::app {

/// Relative errors |G − Ĝ| over |G|, over all responses and lines of a set; NaN where there is
/// nothing to compare.
struct Gain {
  double fit_before = 0.0, fit_after = 0.0;            ///< on what the diagnosis saw
  double held_out_before = 0.0, held_out_after = 0.0;  ///< on channels and lines that it did not
  double noise_floor = 0.0, held_out_noise = 0.0;
  std::vector<std::string> held_out;  ///< what was held out, in words
  bool pays = true;                   ///< the extension is better on what was held out
};

struct Diagnosed {
  MeasuredFrfs measured;  ///< receptances within the band, all channels of the study
  modal::FrfSet seen;     ///< without what was held out
  Solution before;        ///< of the study, with as many modes as a diagnosis needs
  diagnosis::Structure structure;
  diagnosis::Comparison comparison;
  diagnosis::Diagnosis result;
  std::vector<diagnosis::Detectable> detectable;  ///< that the same experiment would find
  std::optional<ExtendedStudy> extended;          ///< where a cause was named
  std::optional<Solution> after;                  ///< the extended study, solved in full
  std::vector<Eigen::MatrixXcd> response_before, response_after;  ///< [k], on `measured`
  Gain gain;
};

/// The measured responses, the study's structure, the comparison, the diagnosis, the extended study
/// solved again, the gain.
/// @throws as its steps
[[nodiscard]] Diagnosed diagnosed(const Study& study, Run& run);

[[nodiscard]] std::string diagnosis_table(const Diagnosed& diagnosed);
[[nodiscard]] io::JsonObject diagnosis_json(const Diagnosed& diagnosed);
/// The verdict in a sentence.
[[nodiscard]] std::string verdict_text(const diagnosis::Diagnosis& result);
/// "point_mass: 0.2518 +- 0.0001 kg at (127.8, -289.9) mm"
[[nodiscard]] std::string cause_text(const diagnosis::Cause& cause);

/// Verdict, causes, where, what it gains, the modes: a section of the report.
[[nodiscard]] io::Section diagnosis_section(const Diagnosed& diagnosed, const Run& run);

/// diagnosis.json, extended.toml, cause_map.vtu and .png, prediction.png
void leave_diagnosis(const Study& study, const Diagnosed& diagnosed, Run& run, bool main_result);

}  // namespace chladni::app
