// Branch and bound over the relaxation.
#pragma once

#include "placement/determinant.h"

namespace chladni::placement {

/// P + Σ φφᵀ over `sites`, with a trace of the identity so that it can be factorised: r×r.
[[nodiscard]] Eigen::MatrixXd information(const DeterminantProblem& problem,
                                          const std::vector<Eigen::Index>& sites);

/// Fills in the bound of `best`, and betters it and proves it as far as the options let it.
void search(const DeterminantProblem& problem, const DeterminantOptions& options, Choice& best);

}  // namespace chladni::placement
