// One orientation for shapes that mathematics leaves free: the sign of a mode, the basis of a
// repeated one.
#pragma once

#include <vector>

#include "fem/modes.h"
#include "fem/system.h"

namespace chladni::fem {

/// Turns the basis of each repeated eigenvalue (modal::kEqualToTheSolver) so that the second
/// moments of the mass that moves, Φᵀ(M x²)Φ, then with y², xy, xz, yz, z³, x³ ... for what is
/// left, are diagonal, the largest first; then gives every flexible shape its sign: the first of
/// its largest entries (to 1e-6) is positive. Columns before `rigid` stay. Returns the turned ones,
/// of two and more.
/// @param lambda  ascending; the values of a turned cluster are replaced by their Rayleigh
/// quotients
std::vector<Cluster> orient(const System& system, Eigen::VectorXd& lambda, Eigen::MatrixXd& shapes,
                            Eigen::Index rigid);

/// Modes from `rigid` on whose neighbours lie within modal::kSplitByMesh, two and more.
std::vector<Cluster> clusters(const Eigen::VectorXd& lambda, Eigen::Index rigid);

}  // namespace chladni::fem
