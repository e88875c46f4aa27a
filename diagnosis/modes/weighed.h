// Posterior probabilities of all hypotheses about modal data.
#pragma once

#include <vector>

#include "diagnosis/modes/search/modes_search.h"

namespace chladni::diagnosis {

/// Hypotheses with their posterior probabilities, which sum to 1.
struct Weighed {
  std::vector<const ModesFit*> fits;
  std::vector<double> probability;
};

/// ln of the prior probability of one hypothesis with this number of causes, of so many that may be
/// (at least 1).
[[nodiscard]] double log_of_number(std::size_t causes, double effects);

/// True if the hypothesis has a cause like this one.
[[nodiscard]] bool contains(const Structure& structure, const ModesFit& fit, const Supposed& cause);

/// True if both have like causes and believe the same numbers.
[[nodiscard]] bool are_alike(const Structure& structure, const ModesFit& a, const ModesFit& b);

/// Each explanation of `found` once, at its best fit, descending. Other fits of it are the same
/// maximum, reached from other starts: their probabilities do not count. An explanation whose
/// simpler case has nearly its evidence is none of its own. Its weight is that of the simpler case:
/// where the general one is true, what the simpler one says is true as well. Evidence counts by its
/// power of `found` (a coarsened posterior: Miller and Dunson, J. Am. Stat. Assoc. 114, 2019): what
/// the errors of real structures are beyond the classes that are learned makes it too sure.
/// @param found  must outlive it
/// @param equal  [ln] evidences that differ by less are nearly the same
[[nodiscard]] Weighed weighed(const Structure& structure, const ModesFound& found, double equal);

/// Sum of the probabilities of the explanations with a cause like this one.
[[nodiscard]] double probability_of(const Structure& structure, const Weighed& all,
                                    const Supposed& cause);

/// True if each cause may be named: several have clear sizes, and bring `least_evidence` [ln] more
/// than any explanation of fewer.
[[nodiscard]] bool is_supported(const ModesFound& found, const ModesFit& fit,
                                double least_evidence);

/// True if a fit with these causes and more brings `least_evidence` [ln] more.
[[nodiscard]] bool is_part_of_more(const Structure& structure, const ModesFound& found,
                                   const ModesFit& fit, double least_evidence);

/// The most probable supported explanation first where the most probable one has its causes and a
/// further one that is not supported.
void put_supported_first(const Structure& structure, const ModesFound& found, double least_evidence,
                         Weighed& all);

}  // namespace chladni::diagnosis
