// Symmetries of a plate that its simulated shapes keep.
#pragma once

#include <vector>

#include "priors/interpolator.h"
#include "priors/kernel.h"

namespace chladni::priors {

/// Per mode of the simulation: the turns and mirrors of a square about the middle of its surface,
/// seen along the common `direction`, that leave the surface as it is and the shape up to its sign.
/// Those of modes within 1 % of each other in frequency must agree, since their basis is arbitrary.
/// The identity alone where there is no symmetry. The square lies along the axes x, y, z.
[[nodiscard]] std::vector<Symmetry> shape_symmetries(const Simulation& simulation,
                                                     const Eigen::RowVector3d& direction);

}  // namespace chladni::priors
