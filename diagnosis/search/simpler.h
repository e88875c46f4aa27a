// What of an explanation is worth its evidence.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// Into fits of descending evidence, the first `fixed` apart.
void keep(std::vector<Fit>& fits, Fit fit, std::ptrdiff_t fixed = 0);

/// The tolerances alone, also fitted from where a fit with causes has them: the better of the two.
[[nodiscard]] Fit nothing_beside(const Problem& problem, const Fit& nothing, const Fit& fit);

/// Without one of its causes, fitted again unless that is known; `nothing` where it was the last.
[[nodiscard]] Fit without(const Problem& problem, const Fit& fit, std::size_t which,
                          const Fit& nothing);

/// Whether one more cause is more than luck, and more than what mends errors of the others
/// (Effect::error).
[[nodiscard]] bool is_sure(const Problem& problem, const SearchLimits& limits, const Fit& nothing,
                           const Fit& less, const Fit& more);

/// What in ln of evidence another mesh or solver, and what each cause is only nearly
/// (Effect::error), may have left of a fit: a further cause that brings less only mends that.
[[nodiscard]] double cost_of_errors(const Problem& problem, const Fit& nothing, const Fit& fit);

/// Without each cause in turn, on a problem of its own; the simpler stays where that costs less
/// than `least_evidence`, or where neither its share nor what is left without it nor its own
/// evidence matters. It may be `nothing` in the end. It knows Fit::less.
[[nodiscard]] Fit pruned(const Problem& problem, const Fit& whole, const Fit& nothing,
                         const SearchLimits& limits);

/// With simpler effects (simpler_of) in the place of each cause of the best fit that has some and
/// pushes on the body about as they would: where both explain the data as well the simpler is
/// meant, but it need not have been tried. After the best, and with two of them exchanged where one
/// was within `equal` of evidence. Returns the best with all that was exchanged.
Fit add_simpler(const Problem& problem, Found& found, double equal);

/// The best fit pruned, with simpler ones beside it; first of all those with what was exchanged,
/// where that leaves a cause too little evidence for itself.
void trim(const Problem& problem, Found& found, const SearchLimits& limits, double equal);

}  // namespace chladni::diagnosis
