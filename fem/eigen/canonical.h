// One fixed choice where mathematics leaves the shapes free: the sign of a mode and the basis of a
// repeated mode.
#pragma once

#include <vector>

#include "fem/modes.h"
#include "fem/system.h"

namespace chladni::fem {

/// Rotates the basis of each repeated eigenvalue (modal::kEqualToTheSolver) so that the second
/// moments of the moving mass, Φᵀ(M x²)Φ, are diagonal, the largest first. Shapes that remain equal
/// are separated by y², xy, xz, yz, then by further moments up to degree 4. Then every flexible
/// shape gets its sign: the first of its largest entries (to 1e-6) is positive. Columns before
/// `rigid` stay as they are. Returns the rotated clusters, each of two or more modes.
/// @param lambda  ascending; the values of a rotated cluster are replaced by their mean
std::vector<Cluster> orient(const System& system, Eigen::VectorXd& lambda, Eigen::MatrixXd& shapes,
                            Eigen::Index rigid);

/// Clusters of two or more modes, from column `rigid` on, whose neighbouring frequencies differ by
/// less than modal::kSplitByMesh.
std::vector<Cluster> clusters(const Eigen::VectorXd& lambda, Eigen::Index rigid);

}  // namespace chladni::fem
