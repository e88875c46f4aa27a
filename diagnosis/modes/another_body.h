// Whether changes of the whole body are so large that the modes are those of another body.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// Errors of the frequencies that a fit leaves.
struct FrequencyErrors {
  double level = 0.0;       ///< [ln] their deviation
  double determined = 0.0;  ///< number of them that the data determine
};

/// The probability [1] that modes are those of another body, rather than of the structure with
/// these causes. What the prior of a whole-body size (Effect::is_of_body) costs beyond
/// Constants::usual_body widths, another body does not pay, since its material and dimensions are
/// its own. But its frequencies would be off by a real model's largest error
/// (Constants::real_frequency), so errors below that speak for the structure. The prior odds are
/// Constants::another_body. 0 where no size lies beyond.
[[nodiscard]] double of_another_body(const Structure& structure,
                                     const std::vector<Supposed>& causes,
                                     const FrequencyErrors& errors);

/// What to do then.
[[nodiscard]] std::string another_body_in_words();

}  // namespace chladni::diagnosis
