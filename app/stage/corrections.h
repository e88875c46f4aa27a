// What may be wrong of a study's body: the corrections that measured shapes can teach.
#pragma once

#include <vector>

#include "app/stage/solution.h"
#include "priors/interpolator.h"

namespace chladni::app {

/// How wrong a body may be, relative deviations.
struct BodyUncertainty {
  double stiffness = 0.2;   ///< of the longest waves of modulus; falls with the wave number
  double anisotropy = 0.2;  ///< one long side against the other, across, and in shear
  double point_mass = 0.5;  ///< of each mass over its share of the body's
  int waves = 4;            ///< 0 to waves − 1 half waves along each of the two longest sides
  int masses = 8;           ///< along the longest side, fewer along the second in proportion
};

/// Cosines of the moduli over the two longest sides of the body, the anisotropy of its materials
/// there, and masses on a regular grid over its surface, its rim included, which move in all three
/// directions. On all modes of the solution; rigid-body modes stay stress-free exactly. The whole's
/// modulus and mass are left to what every prior learns.
/// Cost: fem::field_matrices with as many fields as waves², and four times with one.
[[nodiscard]] std::vector<priors::Correction> corrections(const Solution& solution,
                                                          const BodyUncertainty& uncertain = {});

}  // namespace chladni::app
