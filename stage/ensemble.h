// Uncertain variants of the body that a study describes.
#pragma once

#include <vector>

#include "priors/interpolator.h"
#include "stage/solution.h"

namespace chladni::stage {

/// A body that differs from the study's, in the basis of the study's modes.
using Member = priors::SimilarModel;

/// `plan.members` draws of smooth random fields of modulus, density and thickness, and of four
/// attached masses at random places of the surface. Rayleigh-Ritz on the computed modes:
/// frequencies are slightly too high, and nodal lines move realistically. A draw that leaves no
/// positive stiffness or mass is no body, and is drawn again.
/// @throws NumericalFailure  a hundred draws leave none
[[nodiscard]] std::vector<Member> ensemble(const Solution& solution,
                                           const study::UncertaintyPlan& plan, unsigned seed);

}  // namespace chladni::stage
