// Possible errors of a believed plate, for priors.
#pragma once

#include "priors/interpolator.h"
#include "simulators/plates/kirchhoff_plate.h"

namespace chladni::simulators {

struct PlateUncertainty {
  int waves = 4;            ///< 0 to waves − 1 half waves along each side
  double stiffness = 0.2;   ///< relative, of the longest waves; as 1/wave number beyond
  double anisotropy = 0.2;  ///< relative: along x against y, d12, d66
  int masses = 8;           ///< on a regular grid of masses × masses, including the rim
  double point_mass = 0.5;  ///< of each mass, over its share of the plate's mass
};

/// Cosines over both sides as fields of stiffness, its anisotropy, and masses on a regular grid.
[[nodiscard]] std::vector<priors::Correction> plate_corrections(
    const KirchhoffPlate& plate, const PlateModes& modes, const PlateUncertainty& uncertain = {});

}  // namespace chladni::simulators
