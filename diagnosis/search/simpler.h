// Reduction of an explanation to the causes that are worth their evidence.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// Inserts a fit into fits of descending evidence, after the first `fixed` ones.
void keep(std::vector<Fit>& fits, Fit fit, std::ptrdiff_t fixed = 0);

/// Keeps a fit, unless one of the same causes is about as good (Constants::exchange_gain).
void keep_if_new(const Structure& structure, std::vector<Fit>& fits, Fit fit);

/// The better of two fits of the tolerances alone: `nothing`, and one that starts from the
/// tolerances of a fit with causes.
[[nodiscard]] Fit nothing_beside(const Problem& problem, const Fit& nothing, const Fit& fit);

/// The fit without one of its causes, fitted again unless that is known: from its own deviations,
/// and from those of `nothing` if it then explains less than that. `nothing` if no cause is left,
/// or if the others are impossible without it (a mass that is taken away beside one that is added).
/// What the cause brings is then an upper bound.
[[nodiscard]] Fit without(const Problem& problem, const Fit& fit, std::size_t which,
                          const Fit& nothing);

/// True if one more cause is more than luck, and more than a correction of errors of the others
/// (Effect::error).
[[nodiscard]] bool is_sure(const Problem& problem, const SearchLimits& limits, const Fit& nothing,
                           const Fit& less, const Fit& more);

/// ln of evidence that model-form errors may have left in a fit: those of mesh or solver, and those
/// of each cause (Effect::error). A further cause that brings less only corrects these errors.
[[nodiscard]] double cost_of_errors(const Problem& problem, const Fit& nothing, const Fit& fit);

/// Leaves out each cause in turn, in a new fit. The simpler fit stays if it costs less than
/// `least_evidence`, or if neither the cause's share, nor the excess without it, nor its own
/// evidence is large enough. The result may be `nothing`. Fit::less is set.
[[nodiscard]] Fit pruned(const Problem& problem, const Fit& whole, const Fit& nothing,
                         const SearchLimits& limits);

/// Replaces each cause of the best fit by its simpler effects (Effect::simpler), if these push on
/// the body about as the cause does. If both explain the data equally well, the simpler one is
/// preferred, but the search need not have tried it. The new fits enter after the best. A
/// replacement stays if it costs less than `equal` of evidence or than its share (Simpler). Returns
/// the best fit with all replacements.
Fit add_simpler(const Problem& problem, Found& found, double equal);

/// Prunes the best fit and adds simpler effects to the list. The fit with all replacements comes
/// first if one of its causes then has too little evidence.
void trim(const Problem& problem, Found& found, const SearchLimits& limits, double equal);

}  // namespace chladni::diagnosis
