// What was measured beside the simulation of a study, before any cause is sought.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/compare.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/measured_modes.h"
#include "stage/solution.h"
#include "steps/diagnosis/diagnosis_gain.h"
#include "steps/identification.h"

namespace chladni::steps {

/// Where modes alone were measured, `measured`, `seen`, `comparison` and `predictions` are empty;
/// where responses were measured, `modes` is.
struct Compared {
  MeasuredFrfs measured;   ///< receptances within the band, all channels of the study
  modal::FrfSet seen;      ///< without the held-out channels and lines
  stage::Solution before;  ///< solution of the study, with enough modes for a diagnosis
  diagnosis::Structure structure;
  diagnosis::Comparison comparison;
  std::optional<diagnosis::MeasuredModes> modes;  ///< of the study's file, instead of responses
  Predictions predictions;                        ///< on `measured`; of a comparison only `before`
};

/// Whether the study has a file of modes instead of responses.
[[nodiscard]] bool is_by_modes(const study::Study& study);

/// A comparison that no diagnosis follows.
struct StudyComparison : Compared {
  /// Each measured mode of a file beside the simulated one that it is paired with; empty where
  /// responses were measured. The MAC is NaN where frequencies alone were measured.
  std::vector<diagnosis::ModeTold> modes_beside;
};

/// Reads the measured responses or modes, solves the study, and compares. No cause is sought.
/// @throws InvalidInput  nothing is measured; as its steps and diagnosis::diagnosed
[[nodiscard]] StudyComparison compared(const study::Study& study, stage::Work& work);

}  // namespace chladni::steps
