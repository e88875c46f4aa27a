// Poles to choose the modes from, before any likelihood.
#pragma once

#include "identification/identified.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {

/// Poles and the residues that go with them.
struct StartPoles {
  Eigen::VectorXcd pole;  ///< [rad/s]
  ResidueProblem problem;
  Eigen::Index order = 0;  ///< of the vector fit
};

/// Vector fits from the resonances that stand out, of rising order until a higher one leaves hardly
/// less.
[[nodiscard]] StartPoles start_poles(const FitData& data, const IdentificationOptions& options);

}  // namespace chladni::identification
