// Poles to choose the modes from, before the likelihood is used.
#pragma once

#include "identification/identified.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {

/// Poles with the problem of their residues.
struct StartPoles {
  Eigen::VectorXcd pole;  ///< [rad/s]
  ResidueProblem problem;
  Eigen::Index order = 0;  ///< order of the vector fit
};

/// Vector fits that start from the visible resonances. The order rises until a higher one
/// hardly lowers the cost. Tells options.fit.progress before each.
/// @throws as vector_fit
[[nodiscard]] StartPoles start_poles(const FitData& data, const IdentificationOptions& options);

}  // namespace chladni::identification
