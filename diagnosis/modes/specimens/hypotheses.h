// Which entries of which specimens are wrong: the hypotheses that are compared.
#pragma once

#include <vector>

#include "diagnosis/modes/specimens/joint.h"

namespace chladni::diagnosis {

/// Hypotheses with their posterior probabilities, the most probable first. Not all are fitted: the
/// least promising ones have the evidence that they promise, and an empty JointFit::inverse.
struct WeighedFits {
  std::vector<JointFit> fits;
  std::vector<double> probability;

  /// The hypothesis that every entry is right.
  [[nodiscard]] const JointFit& none() const;
  [[nodiscard]] double probability_of(Eigen::Index entry) const;
};

/// "None", each entry, the best pairs and triples, and each body that is not of this design.
/// @param most_entries  wrong at once, 0 to 3
[[nodiscard]] WeighedFits weighed_hypotheses(const JointModel& model, const Series& series,
                                             int most_entries);

/// Numbers that no hypothesis of "none" believes, the worst first: their noise is set to that of a
/// stray, one after the other.
[[nodiscard]] std::vector<Eigen::Index> set_strays_aside(Series& series, bool learned);

}  // namespace chladni::diagnosis
