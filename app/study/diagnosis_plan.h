// What a study asks of its diagnosis.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/study/place.h"
#include "diagnosis/tolerances.h"

namespace chladni::app {

/// What `chladni diagnose` looks for, and what it takes for no effect.
struct DiagnosisPlan {
  double low_hz = 0.0, high_hz = 0.0;     ///< the band; high 0: all lines
  std::filesystem::path tolerances_file;  ///< or empty
  diagnosis::Tolerances tolerances;       ///< of the file, of the study, or the usual ones
  std::vector<std::string> effects;       ///< names; empty: all
  FacePlan on;                            ///< faces on which causes are sought (app/stage/faces.h)
  int most_causes = 3;
  double least_evidence = 8.0, rival_within = 5.0;  ///< ln Z
  int lines = 320;                                  ///< of the search, at most
  /// Lines that no fit may see: the gain is measured there; 0 and 0: none.
  double hold_out_low_hz = 0.0, hold_out_high_hz = 0.0;
};

/// Tolerances of a diagnosis from a file of their own (docs/reference/study.md#tolerances); what it
/// does not say is as usual. @throws InvalidInput  all that is wrong with it, as read_study
[[nodiscard]] diagnosis::Tolerances read_tolerances(const std::filesystem::path& file);

}  // namespace chladni::app
