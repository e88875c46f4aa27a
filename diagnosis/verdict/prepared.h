// Data of a diagnosis before the search for causes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/modes/calibration/constants_held.h"
#include "diagnosis/observed.h"

namespace chladni::diagnosis {

struct Prepared {
  std::shared_ptr<const Structure> structure;  ///< with the measured channels only
  Observed observed;                           ///< on all lines
  std::vector<std::string> notes;
  std::vector<Deviation> tolerable;  ///< deviations of *structure
  /// Errors of its mode shapes: noise in the search, parameters in the final fit.
  std::vector<Deviation> shapes;
  double response = 0.0;      ///< Tolerances::response, the size of `shapes`
  double solver_error = 0.0;  ///< Problem::solver_error, from the same tolerance

  /// At most `lines` lines for the search, with its widened noise.
  [[nodiscard]] Observed for_search(int lines) const;
  /// All deviations, for the final fit.
  [[nodiscard]] std::vector<Deviation> all_deviations() const;
};

/// @throws as diagnosed
[[nodiscard]] Prepared prepared(const Structure& structure, const modal::FrfSet& measured,
                                const Tolerances& tolerances);

/// Constants that are calibrated in every hypothesis, and where their fits start.
struct Calibration {
  std::vector<HeldConstant> constants;
  Eigen::VectorXd start;  ///< ln of each over the study's
  std::vector<std::string> notes;
};

/// Those of `options.constants` that the structure can show.
/// @param start  as FitStart::constants
/// @throws as held_constants
[[nodiscard]] Calibration calibration_of(const Structure& structure,
                                         const DiagnosisOptions& options,
                                         const std::vector<CalibratedNumber>& start = {});

/// The data with the constants as the last of the deviations that are no shapes, instead of the
/// tolerances that they take over.
/// @throws as diagnosed
[[nodiscard]] Prepared prepared_with(const Structure& structure, const modal::FrfSet& measured,
                                     const DiagnosisOptions& options,
                                     const Calibration& calibration);

}  // namespace chladni::diagnosis
