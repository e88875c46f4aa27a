// The last fits of a diagnosis: the best explanations of the search, with all deviations.
#pragma once

#include "diagnosis/search/search.h"
#include "diagnosis/verdict/prepared.h"

namespace chladni::diagnosis {

/// The limits of a search with these options. Errors of the mode shapes give no hints.
[[nodiscard]] SearchLimits limits_of(const Prepared& given, const DiagnosisOptions& options);

/// Fits the best few again, on the lines of `problem` and with its deviations, among which are the
/// errors of the mode shapes. The search took these errors as noise.
[[nodiscard]] Found fitted_again(const Problem& problem, const Found& found);

}  // namespace chladni::diagnosis
