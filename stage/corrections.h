// Possible errors of a study's body: the corrections that can be learned from measured shapes.
#pragma once

#include <vector>

#include "priors/interpolator.h"
#include "stage/solution.h"

namespace chladni::stage {

/// Uncertainty of a body, relative standard deviations.
struct BodyUncertainty {
  double stiffness = 0.2;   ///< of the longest waves of modulus; smaller for higher wave numbers
  double anisotropy = 0.2;  ///< one long side against the other, between them, and in shear
  double point_mass = 0.5;  ///< of each mass, relative to its share of the body's mass
  int waves = 4;            ///< 0 to waves − 1 half waves along each of the two longest sides
  int masses = 8;           ///< along the longest side, fewer along the second in proportion
};

/// Corrections on all modes of the solution: cosines of the moduli over the two longest sides of
/// the body, the anisotropy of its materials there, and masses on a regular grid over its surface
/// and its rim, which move in all three directions. Rigid-body modes stay exactly stress-free.
/// Modulus and mass of the whole body are not included, because every prior learns them.
/// Cost: fem::field_matrices with as many fields as waves², and four times with one.
[[nodiscard]] std::vector<priors::Correction> corrections(const Solution& solution,
                                                          const BodyUncertainty& uncertain = {});

}  // namespace chladni::stage
