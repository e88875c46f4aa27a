// Whether what a search names rests on more than the last bits of its numbers.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// The structure with frequencies and shapes at its channels off by 1e-9, as another number of
/// threads or another processor may compute them.
[[nodiscard]] Structure nudged(Structure structure);

/// Which causes of a fit another one does not have: of another effect or choice, or in another
/// place.
[[nodiscard]] std::vector<std::size_t> not_repeated(const Structure& structure, const Fit& told,
                                                    const Fit& again);

/// Whether a second search may take something back: another path may end elsewhere where more than
/// noise is left beside a cause that is more likely than not, or where a fit has not converged.
/// @param best  the fit that `diagnosis.best` was made of
[[nodiscard]] bool is_doubtful(const Diagnosis& diagnosis, const Fit& best);

/// What a second search does not name again has a probability of 0.5 at most, and `named` becomes
/// `partial`. Of its fits those count that a last word would take up.
/// @param best  the fit that `diagnosis.best` was made of
/// @return a note that says so, or empty: all is named again
[[nodiscard]] std::string doubt(const Structure& structure, const Fit& best, const Found& second,
                                Diagnosis& diagnosis);

/// What to doubt in fits that were told, or empty: the number of numbers is that of the problem.
[[nodiscard]] std::string note_on_convergence(const Fit& best, const Fit& nothing);
/// Less is left than the stated noise: χ² and what the deviations took are four standard deviations
/// below what independent noise leaves.
[[nodiscard]] std::string note_on_noise(const Fit& best, double numbers);

}  // namespace chladni::diagnosis
