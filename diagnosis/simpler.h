// What of an explanation is worth its evidence.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/search.h"

namespace chladni::diagnosis {

/// Into fits of descending evidence, the first `fixed` apart.
void keep(std::vector<Fit>& fits, Fit fit, std::ptrdiff_t fixed = 0);

/// Without one of its causes, fitted again unless that is known; `nothing` where it was the last.
[[nodiscard]] Fit without(const Problem& problem, const Fit& fit, std::size_t which,
                          const Fit& nothing);

/// Whether one more cause is more than luck, and more than what mends errors of the others
/// (Effect::error).
[[nodiscard]] bool is_sure(const Problem& problem, const SearchLimits& limits, const Fit& nothing,
                           const Fit& less, const Fit& more);

/// With a simpler effect (simpler_of) in the place of each cause of the best fit that has one:
/// where both explain the data as well it is meant, but it need not have been tried. After the
/// best.
void add_simpler(const Problem& problem, Found& found);

/// Without each cause in turn, on a problem of its own; the simpler stays where that costs less
/// than `least_evidence`, or where neither its share nor what is left without it nor its own
/// evidence matters. It may be `nothing` in the end. It knows Fit::less.
[[nodiscard]] Fit pruned(const Problem& problem, const Fit& whole, const Fit& nothing,
                         const SearchLimits& limits);

}  // namespace chladni::diagnosis
