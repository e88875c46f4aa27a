// The diagnosis that a study asks for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diagnosis/proposal.h"
#include "diagnosis/tolerances.h"
#include "study/place.h"

namespace chladni::study {

/// What `chladni diagnose` looks for, and its tolerances.
struct DiagnosisPlan {
  double low_hz = 0.0, high_hz = 0.0;     ///< the band; high 0: all lines
  std::filesystem::path tolerances_file;  ///< or empty
  diagnosis::Tolerances tolerances;       ///< from the file, from the study, or the default ones
  std::vector<std::string> effects;       ///< names; empty: all
  FacePlan on;                            ///< faces on which causes are sought (stage/faces.h)
  int most_causes = 3;
  double least_evidence = 8.0, rival_within = 5.0;  ///< ln Z
  int lines = 320;                                  ///< of the search, at most
  std::string levels = "learned";                   ///< or "known": the tolerances
  diagnosis::MeasurementCosts costs;                ///< of further measurements, in ln evidence
  /// Lines that are held out of every fit, to measure the gain there; 0 and 0: none.
  double hold_out_low_hz = 0.0, hold_out_high_hz = 0.0;
};

/// Tolerances of a diagnosis from a separate file (docs/reference/study.md#tolerances); missing
/// ones have their default.
/// @throws InvalidInput  all errors in it, as read_study
[[nodiscard]] diagnosis::Tolerances read_tolerances(const std::filesystem::path& file);

}  // namespace chladni::study
