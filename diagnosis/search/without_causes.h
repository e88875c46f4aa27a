// Fits of the tolerances alone.
#pragma once

#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// The tolerances alone, fitted from the simulation and from `start` if that is not empty:
/// `nothing` is the better fit, `fits` has it alone, `by_start` tells the difference.
[[nodiscard]] Found fitted_without_causes(const Problem& problem, const Eigen::VectorXd& start);

/// Fits the tolerances alone also from the tolerances of the best fit, as its rivals were.
void fit_nothing_again(const Problem& problem, Found& found);

}  // namespace chladni::diagnosis
