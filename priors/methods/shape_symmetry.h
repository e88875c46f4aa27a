// Symmetries of a plate that its simulated shapes have as well.
#pragma once

#include <vector>

#include "priors/interpolator.h"
#include "priors/kernel.h"

namespace chladni::priors {

/// For each mode of the simulation: the rotations and reflections of a square about the middle of
/// its surface, seen along the common `direction`, that keep the surface and keep the shape up to
/// its sign. Modes within 1 % in frequency must agree, since their basis is arbitrary. Without
/// symmetry only the identity. The square lies along the axes x, y, z.
[[nodiscard]] std::vector<Symmetry> shape_symmetries(const Simulation& simulation,
                                                     const Eigen::RowVector3d& direction);

}  // namespace chladni::priors
