// Standard deviations of the errors of a model, as data show them.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// Standard deviation of one class of the model's errors, inferred from the data.
struct ErrorLevel {
  std::string of;           ///< "frequency", "shape", ...
  double value = 0.0;       ///< relative; of "place" [m]
  double usual = 0.0;       ///< before the data are seen
  double at_most = 0.0;     ///< a larger one is not believed of a model of this structure
  double determined = 0.0;  ///< number of errors of this class that the data show
};

/// Whether the levels of the model's errors are inferred, or are the tolerances.
enum class Levels { learned, known };

/// The tolerances with learned levels of frequencies, damping ratios, shapes, gains and places in
/// their stead, where these are larger.
[[nodiscard]] Tolerances with_levels(Tolerances tolerances, const std::vector<ErrorLevel>& levels);

/// True if frequencies scatter so much more than the tolerances say (Constants::beyond_tolerance), or
/// shapes (Constants::beyond_response), that no fit within these explains responses. A level of
/// fewer errors than Constants::errors_of_a_level is mostly its prior, and does not count.
[[nodiscard]] bool are_beyond(const Tolerances& tolerances, const std::vector<ErrorLevel>& levels);

}  // namespace chladni::diagnosis
