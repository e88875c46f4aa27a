// What the normal equations of a block model say of the deviations of its parameters. Of this room
// only.
#pragma once

#include <Eigen/Core>

#include "identification/likelihood/normal_equations.h"

namespace chladni::identification {

using Unknown = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// Of n parameters, n×n; where one is not known its row and column are zeros.
struct Covariance {
  Eigen::MatrixXd matrix;
  Unknown unknown;  ///< n: no data speak of it, or a bound holds it
};

/// n×d: directions in the parameters that leave every response as it is.
[[nodiscard]] Eigen::MatrixXd idle_directions(const BlockModel& model, Eigen::Index parameters);

/// Pseudo-inverse of the normal equations that holds the idle directions still, orthogonally to
/// them in the parameters' own metric. Unknown are parameters that change no response, the damping
/// of undamped modes, and what takes part by a hundredth or more in a direction that changes the
/// responses by less than double precision tells (1e-13 of a scaled eigenvalue); the deviations of
/// the others are those with these given.
/// Cost: n³, ten times that where there are such directions.
/// @throws NumericalFailure  the equations are not finite
[[nodiscard]] Covariance held_inverse(const BlockModel& model, const NormalEquations& normal,
                                      const Eigen::MatrixXd& idle);

}  // namespace chladni::identification
