// From fits to what is said: names, places, sizes, probabilities.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/search/search.h"

namespace chladni::diagnosis {

/// Found fits as explanations, each once, with probabilities among them: evidence divided by
/// χ²/N of the best where it leaves more than noise, so that what nobody explains makes nobody
/// sure. Of two within `equal` of evidence the simpler comes first, and so does one that leaves no
/// more of what the other explains than Simpler::share and errors of its own; it then has the
/// other's evidence.
[[nodiscard]] std::vector<Explanation> explanations(const Problem& problem, const Found& found,
                                                    double equal);

/// The chance that causes of one kind, each at a random place, are as near to each other; 1 where
/// no two are of one kind.
[[nodiscard]] double by_chance_so_near(const Structure& structure,
                                       const std::vector<Cause>& causes);

/// How far cause `which` is one of its own, 0 to 1: 1 where no other of its kind is told; small
/// where one is so near that a random place is hardly ever, as the parts are of one thing that is
/// spread out.
[[nodiscard]] double of_its_own(const Structure& structure, const std::vector<Cause>& causes,
                                std::size_t which);

/// The verdict on them; `explanations.front()` is the best.
[[nodiscard]] Verdict judged(const Problem& problem, const Found& found,
                             const std::vector<Explanation>& explanations,
                             const DiagnosisOptions& options);

/// χ² per number of what a fit leaves.
[[nodiscard]] Residue residue(const Problem& problem, const Fit& fit);

}  // namespace chladni::diagnosis
