// Branch and bound over the relaxation.
#pragma once

#include "placement/determinant.h"

namespace chladni::placement {

/// P + Σ φφᵀ over `sites`, plus a very small multiple of the identity for the factorisation: r×r.
[[nodiscard]] Eigen::MatrixXd information(const DeterminantProblem& problem,
                                          const std::vector<Eigen::Index>& sites);

/// Sets the bound of `best`, and improves and proves `best` as far as the options allow.
void search(const DeterminantProblem& problem, const DeterminantOptions& options, Choice& best);

}  // namespace chladni::placement
