// Tests whether the causes that a search names depend on rounding errors.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// The structure with frequencies and channel shapes changed by 1e-9. Another number of threads or
/// another processor may cause such a difference.
[[nodiscard]] Structure nudged(Structure structure);

/// Indices of the causes of `told` that `again` lacks: it has no cause of the same effect and
/// choice in the same place.
[[nodiscard]] std::vector<std::size_t> not_repeated(const Structure& structure, const Fit& told,
                                                    const Fit& again);

/// True if a second search may remove a cause, because another path of the search may end at other
/// causes: a cause is more likely than not but more than noise is left, or the fit has not
/// converged.
/// @param best  the fit of `diagnosis.best`
[[nodiscard]] bool is_doubtful(const Diagnosis& diagnosis, const Fit& best);

/// Limits the probability of a cause that a second search does not name again to 0.5, and changes
/// `named` to `partial`. The fits of `second` count that a final fit would use.
/// @param best  the fit of `diagnosis.best`
/// @return a note that says so, or empty if all causes are named again
[[nodiscard]] std::string doubt(const Structure& structure, const Fit& best, const Found& second,
                                Diagnosis& diagnosis);

/// A note on the order of the causes told where a change of an evidence by `within` [ln] would put
/// another explanation first: rounding errors decide where a search and its fits end. Empty where
/// no rival is so near, where the causes are named and where none is told.
/// @param power  of the evidence in the probability of an explanation
[[nodiscard]] std::string note_on_order(const Diagnosis& diagnosis, double within,
                                        double power = 1.0);

/// A note on fits that have not converged; or empty.
[[nodiscard]] std::string note_on_convergence(const Fit& best, const Fit& nothing);
/// A note if the residual is below the stated noise: χ² plus the part taken by the deviations is
/// four standard deviations below its expectation for independent noise. Else empty.
[[nodiscard]] std::string note_on_noise(const Fit& best, double numbers);

}  // namespace chladni::diagnosis
